#pragma once

#include <string>
#include <utility>
#include <vector>

#include "firmware/configuration/runtime.h"
#include "firmware/realtime/bus_interrupts.h"
#include "firmware/supervisor/state.h"

namespace stilt::program {

/// Of the threads that serve buses, those that may run on the planner's processor and wait there for a solve.
/// ksoftirqd is none of them: what an interrupt thread raises, that thread works off itself.
[[nodiscard]] std::vector<realtime::InterruptThread> delayed_threads(
    const std::vector<realtime::BusInterrupts>& buses, const configuration::RuntimeParameters& runtime);

/// "irq/45-can0 (process 117, priority 50)".
[[nodiscard]] std::string thread_text(const realtime::InterruptThread& thread);

/// A sentence for each thread that waits for the planner, with the command that mends it.
[[nodiscard]] std::vector<std::string> delay_sentences(const std::vector<realtime::BusInterrupts>& buses,
                                                       const configuration::RuntimeParameters& runtime);

/// A sentence for each bus with an adapter: "can0 (spi0.0): irq/45-spi0.0 (process 117, priority 50)", or
/// that no thread is known.
[[nodiscard]] std::vector<std::string> interrupt_sentences(const std::vector<realtime::BusInterrupts>& buses);

/// Looks at the interrupt threads again after each reset. A driver of the kernel requests its interrupt when
/// the interface comes up. One that was down, as after a bus-off, has a new thread with the kernel's
/// priority. Reads /proc; housekeeping's.
class InterruptWatch {
 public:
  InterruptWatch(std::vector<std::string> buses, const configuration::RuntimeParameters& runtime,
                 std::string root = "")
      : buses_(std::move(buses)), runtime_(runtime), root_(std::move(root)) {}

  /// At every turn. @return  delay_sentences() where the supervisor has left its fault, else nothing
  [[nodiscard]] std::vector<std::string> update(supervisor::State state);

 private:
  std::vector<std::string> buses_;
  configuration::RuntimeParameters runtime_;
  std::string root_;  ///< where /proc and /sys are looked for
  supervisor::State before_ = supervisor::State::boot;
};

}  // namespace stilt::program
