#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "firmware/control_loop/cycle_record.h"
#include "firmware/control_loop/tick_record.h"

namespace stilt::replay {

/// Where a replay first did something else than the record.
struct Difference {
  std::uint64_t tick = 0;  ///< of the torque loop; of a plan: whose state it starts from
  std::string what;        ///< "sent torque_Nm of knee_L"
  std::string recorded;    ///< its value, numbers with all digits
  std::string replayed;

  /// One sentence: "tick 812: sent torque_Nm of knee_L was 1.25 and is 1.5".
  [[nodiscard]] std::string text() const;
};

/// The first output of a tick that is not the same bit for bit, in the order in which the loop works:
/// estimate, decision, wanted, sent.
[[nodiscard]] std::optional<Difference> compare(const control_loop::TickRecord& recorded,
                                                const control_loop::TickRecord& replayed);

/// The same for a solve of the planner: the request it answers, how it ended, the plan's number and check
/// sum. Its duration and the number of its tuning are inputs of the replay.
[[nodiscard]] std::optional<Difference> compare(const control_loop::CycleRecord& recorded,
                                                const control_loop::CycleRecord& replayed);

}  // namespace stilt::replay
