#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "firmware/control_loop/cycle_record.h"
#include "firmware/control_loop/tick_record.h"

namespace stilt::replay {

/// The first output of a replay that differs from the record.
struct Difference {
  std::uint64_t tick = 0;  ///< of the control loop; for a plan: the tick of its state
  std::string what;        ///< "sent torque_Nm of knee_L"
  std::string recorded;    ///< its value, with all digits of numbers
  std::string replayed;

  /// One sentence: "tick 812: sent torque_Nm of knee_L was 1.25 and is 1.5".
  [[nodiscard]] std::string text() const;
};

/// The first output of a tick that is not equal bit for bit, in the order of the loop: estimate, decision,
/// wanted, sent.
[[nodiscard]] std::optional<Difference> compare(const control_loop::TickRecord& recorded,
                                                const control_loop::TickRecord& replayed);

/// The same for a solve of the planner: its request, its status, the plan's number and checksum. The duration
/// and the number of the tuning are inputs of the replay and not compared.
[[nodiscard]] std::optional<Difference> compare(const control_loop::CycleRecord& recorded,
                                                const control_loop::CycleRecord& replayed);

}  // namespace stilt::replay
