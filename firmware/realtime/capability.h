#pragma once

#include <string>
#include <vector>

#include "firmware/realtime/idle_request.h"

namespace stilt::realtime {

/// What the threads of the program ask of the machine.
struct Requirements {
  int torque_priority = 80;       ///< SCHED_FIFO; 0: none asked for
  int planner_priority = 60;      ///< SCHED_FIFO; 0: none asked for
  int torque_core = -1;           ///< -1: any
  int planner_core = -1;          ///< -1: any
  double idle_exit_max_s = 1e-5;  ///< longest time that a processor may take to leave an idle state
};

/// Whether the machine can keep the torque loop's time, from what it reports of itself; measures nothing.
/// Start-up only.
struct Capability {
  std::string kernel;                ///< release
  bool realtime_kernel = false;      ///< PREEMPT_RT
  int torque_core = -1;              ///< that the torque loop is set to; -1: any
  bool core_isolated = false;        ///< the kernel puts no other program there (isolcpus=)
  std::string governor;              ///< of the torque loop's processor; empty: the kernel does not report it
  bool memory_locked = false;        ///< mlockall succeeded
  bool priority_allowed = false;     ///< a thread may take SCHED_FIFO at the priorities asked for
  int cores = 0;                     ///< processors of this process, with those that its threads may take
  IdleRequest idle;                  ///< held as long as this lives
  std::vector<std::string> lacking;  ///< a sentence for each thing in the way; empty: real time

  [[nodiscard]] bool realtime() const noexcept { return lacking.empty(); }
};

/// Locks present and future memory of the process, asks for short idle states, tries priorities and
/// processors, and reads the rest. `root`: where /dev, /sys and /proc are looked for, for tests.
[[nodiscard]] Capability acquire(const Requirements& requirements, const std::string& root = "");

/// What is lacking, in one line; empty for a machine that can keep time.
[[nodiscard]] std::string lacking_text(const Capability& capability);

}  // namespace stilt::realtime
