#pragma once

#include <array>
#include <string>

#include "firmware/control_loop/events.h"
#include "hal/robot/robot.h"

/// What an event found, in words; the same on the terminal, on the wire and in selftest. Not real time.
namespace stilt::diagnostics {

/// Joint or bus, driver fault with vendor code, condition, value and limit, such as ": knee_L, motor, 92 C,
/// limit 90 C"; empty when it has none.
[[nodiscard]] std::string found_text(const supervisor::FaultDetail& found);

/// The same without the colon.
[[nodiscard]] std::string found_words(const supervisor::FaultDetail& found);

/// The words for every fault, as it was found last; empty: nothing is known.
using FoundWords = std::array<std::string, supervisor::kFaults>;

/// A sentence about a driver that cannot be brought up: joint, failure, driver fault, setting.
[[nodiscard]] std::string bring_up_text(const hal::BringUpProgress& progress);

/// A sentence about the standing pose: which joint is where, and where it would have to be.
[[nodiscard]] std::string pose_text(const control_loop::Event& event);

/// "unknown", "idle", "enabled" or "fault".
[[nodiscard]] const char* state_text(hal::DriverState state);

/// A fault of a driver with its vendor code.
[[nodiscard]] std::string fault_text(hal::DriverFault fault, std::uint32_t code);

/// After the name of a fault whose cause is gone: ": over", and whether it waits for a reset.
[[nodiscard]] std::string over_text(supervisor::Fault fault);

}  // namespace stilt::diagnostics
