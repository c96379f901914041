#pragma once

#include <expected>
#include <functional>
#include <string>
#include <vector>

#include "firmware/configuration/runtime.h"
#include "firmware/realtime/bus_interrupts.h"

namespace stilt::program {

/// Between planner and torque loop: a thread of a bus with this priority waits for no solve and delays no
/// tick.
[[nodiscard]] int interrupt_priority(const configuration::RuntimeParameters& runtime) noexcept;

/// Whether a bus that /sys has no adapter of is well, by its name: a loopback, a vcan, an fdcanusb. So is an
/// interface that is there, as that of an slcan. Any other is missing.
[[nodiscard]] bool may_lack_adapter(const std::string& bus);

/// Gives a thread of the kernel SCHED_FIFO with this priority. @return  why not; empty: done
using SetPriority = std::function<std::string(int process, int priority)>;

/// As root, from the kernel.
[[nodiscard]] std::string set_priority(int process, int priority);

/// Raises those threads of the buses that have the planner's priority or less to interrupt_priority().
/// ksoftirqd stays: what an interrupt thread raises, that thread works off itself. Start-up and ordinary
/// threads.
/// @return  a line for each thread and for each bus without one; the error is a sentence
[[nodiscard]] std::expected<std::string, std::string> raise_interrupts(
    const std::vector<realtime::BusInterrupts>& buses, const configuration::RuntimeParameters& runtime,
    const SetPriority& set = set_priority);

}  // namespace stilt::program
