#pragma once

#include <optional>
#include <string>
#include <vector>

/// What delays a processor beside its load, as the kernel reports it under /sys and /proc. Start-up and
/// ordinary threads.
namespace stilt::realtime {

/// The idle state from which a processor takes longest to wake, of those that the kernel may use.
struct IdleState {
  std::string name;
  double exit_us = 0.0;
};

/// Nothing when the kernel does not report it. `core`: -1 is the first. `root`: where /sys is looked for, for
/// tests.
[[nodiscard]] std::optional<IdleState> deepest_idle_state(int core, const std::string& root = "");

/// How often a processor was slowed down because it was hot, all processors together, since the start of the
/// computer. Nothing when the kernel does not report it, as in a virtual machine and on Arm.
[[nodiscard]] std::optional<long long> thermal_throttle_count(const std::string& root = "");

/// A thread of the kernel that serves an interrupt, or goes on with what one began; there are some on every
/// PREEMPT_RT kernel.
struct InterruptThread {
  std::string name;        ///< "irq/45-can0", "napi/can0-8", "ksoftirqd/0"
  int process = 0;         ///< for chrt and taskset
  int priority = 0;        ///< SCHED_FIFO
  std::string processors;  ///< that it may run on: "0-3,5"
};

/// `root`: where /proc is looked for, for tests.
[[nodiscard]] std::vector<InterruptThread> interrupt_threads(const std::string& root = "");

/// Whether a list of processors such as "0-3,5" holds one; -1, any, is in every list.
[[nodiscard]] bool has_processor(const std::string& list, int core);

}  // namespace stilt::realtime
