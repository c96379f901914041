#include "firmware/realtime/system_call_guard.h"

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include <array>
#include <cstddef>
#include <cstdint>

// Proofs of real time: docs/decisions/0006-supervision-and-real-time-proofs.md
namespace stilt::realtime {
namespace {

#if defined(__x86_64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t kArchitecture = 0;
#endif

constexpr std::uint32_t kAllowed[] = {
    SYS_clock_nanosleep, SYS_clock_gettime,                            // the tick
    SYS_recvmmsg,        SYS_sendmmsg,                                 // the buses
    SYS_getrusage,                                                     // page-fault counters
    SYS_rt_sigprocmask,  SYS_madvise,       SYS_exit, SYS_exit_group,  // end of the thread
};
constexpr std::size_t kCalls = sizeof kAllowed / sizeof kAllowed[0];

constexpr sock_filter load(std::uint32_t offset) { return BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offset); }
constexpr sock_filter skip_unless(std::uint32_t value, std::uint8_t count) {
  return BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, 0, count);
}
constexpr sock_filter verdict(std::uint32_t value) { return BPF_STMT(BPF_RET | BPF_K, value); }

/// Another instruction set: end. A call of the list: allow. Anything else: end.
constexpr auto kFilter = [] {
  std::array<sock_filter, 5 + 2 * kCalls> filter{};
  std::size_t next = 0;
  filter[next++] = load(offsetof(seccomp_data, arch));
  filter[next++] = BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kArchitecture, 1, 0);
  filter[next++] = verdict(SECCOMP_RET_KILL_PROCESS);
  filter[next++] = load(offsetof(seccomp_data, nr));
  for (const std::uint32_t call : kAllowed) {
    filter[next++] = skip_unless(call, 1);
    filter[next++] = verdict(SECCOMP_RET_ALLOW);
  }
  filter[next] = verdict(SECCOMP_RET_KILL_PROCESS);
  return filter;
}();

}  // namespace

bool forbid_other_system_calls() noexcept {
  if (kArchitecture == 0) return false;
  sock_fprog program{};
  program.len = static_cast<unsigned short>(kFilter.size());
  program.filter = const_cast<sock_filter*>(kFilter.data());
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return false;
  return prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

}  // namespace stilt::realtime
