#pragma once

#include <array>
#include <cstdint>

#include "mpc_core/gait/parameters.h"
#include "mpc_core/gait/schedule.h"
#include "mpc_core/ocp/parameters.h"

namespace stilt::ocp {

/// Capacity of the horizon: 2.0 s in 15 ms intervals, up to 21 contact switches, and the final node.
inline constexpr int kMaxHorizonIntervals = 134;
inline constexpr int kMaxSwitches = 21;
inline constexpr int kMaxStages = kMaxHorizonIntervals + 2 * kMaxSwitches + 1;
inline constexpr int kMaxNodes = kMaxStages + 1;

/// Intervals that the time steps of a horizon take; NaN if one of the two is. May run in real time.
[[nodiscard]] double most_intervals(const DiscretisationParameters& parameters) noexcept;

/// Largest number of contact switches that any window of one horizon holds while stepping. May run in real
/// time.
[[nodiscard]] double most_switches(const DiscretisationParameters& parameters,
                                   const gait::GaitParameters& gait) noexcept;

/// The two kinds of stages.
enum class StageKind : std::uint8_t {
  flow,        ///< motion over an interval with one set of feet on the ground
  transition,  ///< touch-down of feet at an instant
};

/// One stage: a flow over an interval, or a transition at an instant.
struct Stage {
  double time_s = 0.0;
  double duration_s = 0.0;  ///< 0 for a transition
  int phase = 0;            ///< index into the contact schedule
  StageKind kind = StageKind::flow;
  model::ContactMode mode;                     ///< contact mode of a flow, or after a transition
  std::array<bool, model::kFeet> touchdown{};  ///< feet that a transition puts down
};

/// The time grid of one planning problem: stage k leads from node k to node k + 1.
struct Horizon {
  int stages = 0;
  double end_s = 0.0;
  int end_phase = 0;
  std::array<Stage, kMaxStages> stage;

  [[nodiscard]] double node_time_s(int node) const noexcept {
    return node < stages ? stage[node].time_s : end_s;
  }
};

/// Builds the time grid: nodes at start + k time_step, at the end, and at every contact switch. Intervals
/// shorter than `merge_below_s` are merged. The grid moves with the start. False when the capacity is too
/// small.
[[nodiscard]] bool build_horizon(const gait::ContactSchedule& schedule, double start_s,
                                 const DiscretisationParameters& parameters, Horizon& horizon) noexcept;

}  // namespace stilt::ocp
