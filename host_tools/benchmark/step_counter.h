#pragma once

#include <functional>

/// Counts the instructions that a piece of code executes, by single-stepping it. The count does not depend on
/// the clock or on other processes, and needs no performance counters. Thousands of times slower than the
/// code. x86-64 only.
namespace stilt::benchmark {

/// Work that a piece of code executed.
struct ExecutedWork {
  long long instructions = 0;
  long long flops = 0;  ///< double-precision additions, products, divisions and roots of all lanes, padding
                        ///< included; a fused multiply-add counts as two

  ExecutedWork& operator+=(const ExecutedWork& other) noexcept {
    instructions += other.instructions;
    flops += other.flops;
    return *this;
  }
  [[nodiscard]] ExecutedWork operator-(const ExecutedWork& other) const noexcept {
    return {instructions - other.instructions, flops - other.flops};
  }
  [[nodiscard]] ExecutedWork operator*(long long times) const noexcept {
    return {instructions * times, flops * times};
  }
};

/// False where single-stepping is impossible: other processors, builds with sanitizers, some sandboxes.
[[nodiscard]] bool can_count_work();

/// Runs the function once and counts. Not reentrant, one thread at a time, not under a debugger. All counts
/// are zero when can_count_work() is false; the function runs nevertheless.
[[nodiscard]] ExecutedWork count_work(const std::function<void()>& function);

/// Floating-point operations of the x86-64 instruction at `code`. Counts VEX, EVEX and legacy encodings of
/// add, sub, mul, div, sqrt, hadd and the fused multiply-adds on doubles. 0 for every other instruction.
[[nodiscard]] int flops_of_instruction(const unsigned char* code) noexcept;

}  // namespace stilt::benchmark
