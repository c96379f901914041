#include "host_tools/benchmark/step_counter.h"

#include <csignal>

#if defined(__x86_64__)
#include <ucontext.h>
#endif

namespace stilt::benchmark {
namespace {

/// The fields of an instruction that determine its operation, common to all three encodings.
struct Encoding {
  int map = 0;      ///< 1: 0F, 2: 0F 38
  int prefix = 0;   ///< 0: none, 1: 66, 2: F3, 3: F2
  int doubles = 2;  ///< lanes of a packed instruction
  unsigned char opcode = 0;
};

constexpr int kPackedDoubles = 1;  // prefix 66
constexpr int kScalarDouble = 3;   // prefix F2

bool is_legacy_prefix(unsigned char byte) noexcept {
  switch (byte) {
    case 0x66:
    case 0xF2:
    case 0xF3:
    case 0x2E:
    case 0x36:
    case 0x3E:
    case 0x26:
    case 0x64:
    case 0x65:
    case 0x67:
      return true;
    default:
      return false;
  }
}

Encoding decode_legacy(const unsigned char* p) noexcept {
  Encoding e;
  for (; is_legacy_prefix(*p); ++p) {
    if (*p == 0x66 && e.prefix == 0) e.prefix = 1;
    if (*p == 0xF3) e.prefix = 2;
    if (*p == 0xF2) e.prefix = 3;
  }
  if ((*p & 0xF0) == 0x40) ++p;  // REX
  if (*p != 0x0F) return e;
  e.map = 1;
  e.opcode = p[1];
  return e;
}

/// Intel 64 and IA-32 Architectures Software Developer's Manual, volume 2, sections 2.3 (VEX) and 2.7 (EVEX).
Encoding decode(const unsigned char* p) noexcept {
  Encoding e;
  if (*p == 0xC5) {
    e = {.map = 1, .prefix = p[1] & 3, .doubles = (p[1] & 4) != 0 ? 4 : 2, .opcode = p[2]};
  } else if (*p == 0xC4) {
    e = {.map = p[1] & 0x1F, .prefix = p[2] & 3, .doubles = (p[2] & 4) != 0 ? 4 : 2, .opcode = p[3]};
    if (e.map == 2 && (p[2] & 0x80) == 0) e.map = 0;  // W = 0: single precision
  } else if (*p == 0x62) {
    e = {.map = p[1] & 7, .prefix = p[2] & 3, .doubles = 2 << ((p[3] >> 5) & 3), .opcode = p[4]};
    const bool registers = (p[5] & 0xC0) == 0xC0;
    if (registers && (p[3] & 0x10) != 0) e.doubles = 8;  // static rounding: always 512 bits
    if ((p[2] & 0x80) == 0) e.map = 0;
  } else {
    e = decode_legacy(p);
  }
  return e;
}

int flops_of_map1(const Encoding& e) noexcept {
  const int lanes = e.prefix == kPackedDoubles ? e.doubles : e.prefix == kScalarDouble ? 1 : 0;
  switch (e.opcode) {
    case 0x51:  // sqrt
    case 0x58:  // add
    case 0x59:  // mul
    case 0x5C:  // sub
    case 0x5E:  // div
      return lanes;
    case 0x7C:  // hadd
    case 0x7D:  // hsub
    case 0xD0:  // addsub
      return e.prefix == kPackedDoubles ? lanes : 0;
    default:
      return 0;
  }
}

/// Operations of the fused multiply-adds: opcodes 96-9F, A6-AF, B6-BF; those ending in 9, B, D, F are scalar.
int flops_of_map2(const Encoding& e) noexcept {
  const int high = e.opcode >> 4;
  const int low = e.opcode & 0xF;
  if (e.prefix != kPackedDoubles || high < 0x9 || high > 0xB || low < 6) return 0;
  const bool scalar = low >= 9 && (low & 1) != 0;
  return 2 * (scalar ? 1 : e.doubles);
}

}  // namespace

int flops_of_instruction(const unsigned char* code) noexcept {
  const Encoding e = decode(code);
  if (e.map == 1) return flops_of_map1(e);
  if (e.map == 2) return flops_of_map2(e);
  return 0;
}

#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

namespace {

ExecutedWork counted;  // written by the signal handler

void on_step(int, siginfo_t*, void* context) {
  const auto* registers = static_cast<const ucontext_t*>(context)->uc_mcontext.gregs;
  counted.instructions += 1;
  // NOLINTNEXTLINE(performance-no-int-to-ptr): the kernel gives the address as a number
  counted.flops += flops_of_instruction(reinterpret_cast<const unsigned char*>(registers[REG_RIP]));
}

/// Sets the processor's trap flag, which raises a signal after each instruction.
[[gnu::noinline]] void start_stepping() noexcept {
  __builtin_ia32_writeeflags_u64(__builtin_ia32_readeflags_u64() | 0x100U);
}
[[gnu::noinline]] void stop_stepping() noexcept {
  __builtin_ia32_writeeflags_u64(__builtin_ia32_readeflags_u64() & ~0x100ULL);
}

ExecutedWork stepped(const std::function<void()>& function) {
  struct sigaction action{};
  struct sigaction before{};
  action.sa_sigaction = on_step;
  action.sa_flags = SA_SIGINFO;
  sigaction(SIGTRAP, &action, &before);
  counted = {};
  start_stepping();
  function();
  stop_stepping();
  sigaction(SIGTRAP, &before, nullptr);
  return counted;
}

}  // namespace

bool can_count_work() {
  static const bool kSteps = stepped([] {}).instructions > 0;  // some sandboxes ignore the flag
  return kSteps;
}

ExecutedWork count_work(const std::function<void()>& function) { return stepped(function); }

#else

bool can_count_work() { return false; }

ExecutedWork count_work(const std::function<void()>& function) {
  function();
  return {};
}

#endif

}  // namespace stilt::benchmark
