#include "host_tools/benchmark/step_counter.h"

#include <gtest/gtest.h>

#include <vector>

#include "host_tools/benchmark/arithmetic_peak.h"

namespace stilt::benchmark {
namespace {

struct Instruction {
  const char* text;
  std::vector<unsigned char> bytes;  ///< as GNU as encodes it
  int flops;
};

TEST(StepCounter, KnowsTheOperationsOfEveryEncoding) {
  const Instruction instructions[] = {
      {"addpd xmm0, xmm1", {0x66, 0x0F, 0x58, 0xC1}, 2},
      {"addsd xmm8, xmm1", {0xF2, 0x44, 0x0F, 0x58, 0xC1}, 1},
      {"mulsd xmm0, xmm1", {0xF2, 0x0F, 0x59, 0xC1}, 1},
      {"haddpd xmm0, xmm1", {0x66, 0x0F, 0x7C, 0xC1}, 2},
      {"vaddpd ymm0, ymm0, ymm1", {0xC5, 0xFD, 0x58, 0xC1}, 4},
      {"vaddpd xmm0, xmm0, xmm1", {0xC5, 0xF9, 0x58, 0xC1}, 2},
      {"vsubsd xmm0, xmm0, xmm1", {0xC5, 0xFB, 0x5C, 0xC1}, 1},
      {"vdivpd ymm0, ymm0, ymm9", {0xC4, 0xC1, 0x7D, 0x5E, 0xC1}, 4},
      {"vsqrtpd ymm0, ymm1", {0xC5, 0xFD, 0x51, 0xC1}, 4},
      {"vfmadd132pd ymm0, ymm1, ymm2", {0xC4, 0xE2, 0xF5, 0x98, 0xC2}, 8},
      {"vfmadd231sd xmm0, xmm1, xmm2", {0xC4, 0xE2, 0xF1, 0xB9, 0xC2}, 2},
      {"vfnmadd213pd xmm0, xmm1, xmm2", {0xC4, 0xE2, 0xF1, 0xAC, 0xC2}, 4},
      {"vaddpd zmm0, zmm0, zmm1", {0x62, 0xF1, 0xFD, 0x48, 0x58, 0xC1}, 8},
      {"vmulpd ymm16, ymm0, ymm1", {0x62, 0xE1, 0xFD, 0x28, 0x59, 0xC1}, 4},
      {"vaddpd zmm0, zmm0, zmm1, {rd-sae}", {0x62, 0xF1, 0xFD, 0x38, 0x58, 0xC1}, 8},
      {"vfmadd231pd zmm0, zmm1, zmm2", {0x62, 0xF2, 0xF5, 0x48, 0xB8, 0xC2}, 16},
      {"addps xmm0, xmm1", {0x0F, 0x58, 0xC1}, 0},
      {"vaddps ymm0, ymm0, ymm1", {0xC5, 0xFC, 0x58, 0xC1}, 0},
      {"vfmadd132ps ymm0, ymm1, ymm2", {0xC4, 0xE2, 0x75, 0x98, 0xC2}, 0},
      {"vmaxpd ymm0, ymm0, ymm1", {0xC5, 0xFD, 0x5F, 0xC1}, 0},
      {"vmovapd ymm0, ymm1", {0xC5, 0xFD, 0x28, 0xC1}, 0},
      {"pop rax", {0x58, 0x0F, 0x58, 0xC1}, 0},
      {"ret", {0xC3, 0x00, 0x00, 0x00}, 0},
  };
  for (const Instruction& instruction : instructions) {
    std::vector<unsigned char> code = instruction.bytes;
    code.resize(16);
    EXPECT_EQ(flops_of_instruction(code.data()), instruction.flops) << instruction.text;
  }
}

TEST(StepCounter, CountsThePeakKernelExactly) {
  if (!can_count_work()) GTEST_SKIP() << "this processor or build cannot be stepped through";
  volatile double factor = 0.5;
  double total = 0.0;
  const ExecutedWork work = count_work([&] { total = peak_kernel(factor, 1.0); });
  EXPECT_DOUBLE_EQ(total, 2.0 * kPeakAccumulators * model::kLanes) << "s = s / 2 + 1 goes to 2";
  const long long additions_at_the_end = kPeakAccumulators * model::kLanes;
  EXPECT_GE(work.flops, kPeakFlops);
  EXPECT_LE(work.flops, kPeakFlops + 2 * additions_at_the_end);
  const long long fused = static_cast<long long>(kPeakAccumulators) * kPeakRounds;
  EXPECT_GE(work.instructions, fused);
  EXPECT_LE(work.instructions, fused + fused / 2) << "more than multiply-adds and the loop";
}

TEST(StepCounter, GivesTheSameCountEachTime) {
  if (!can_count_work()) GTEST_SKIP() << "this processor or build cannot be stepped through";
  volatile int sum = 0;
  const auto loop = [&] {
    for (int i = 0; i < 100; ++i) sum = sum + i;
  };
  const long long first = count_work(loop).instructions;
  EXPECT_GE(first, 300);
  EXPECT_EQ(count_work(loop).instructions, first);
}

}  // namespace
}  // namespace stilt::benchmark
