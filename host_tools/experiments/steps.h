#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "host_tools/recording/run_record.h"

/// Quantities computed from the touch-downs of a walk.
namespace stilt::experiments {

struct StepRange {
  double min_m = 0.0, max_m = 0.0;
};

/// Shortest and longest of the steps that land at `from_s` or later; nothing when there are none.
[[nodiscard]] std::optional<StepRange> step_range(std::span<const log::Step> steps, double from_s);

/// Mean length of the steps of one foot, "L" or "R", that land at `from_s` or later; nothing when there are
/// none.
[[nodiscard]] std::optional<double> mean_step_m(std::span<const log::Step> steps, std::string_view foot,
                                                double from_s);

/// Number of steps until a pushed walk is as fast again as an unpushed one.
///
/// Touch-down 0 is the last one at or before the end of the push; touch-downs 1, 2, ... follow. The speed at
/// touch-down n is the mean speed of the hip over the two steps that begin there. It is a recovered speed
/// within 10 % of `unpushed_speed_m_s`, or within 0.03 m/s where that is more. The walk has recovered at the
/// smallest n at which this speed and those at the next three touch-downs are recovered. Nothing when there
/// is no such n.
[[nodiscard]] std::optional<int> recovery_steps(std::span<const log::Step> steps, double push_end_s,
                                                double unpushed_speed_m_s);

}  // namespace stilt::experiments
