#include "host_tools/experiments/steps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace stilt::experiments {
namespace {

constexpr double kTimeSlack_s = 1e-9;
constexpr std::size_t kStride = 2;  // steps, one of each leg
constexpr int kStays = 4;           // consecutive touch-downs
constexpr double kShare = 0.1;
constexpr double kLeastTolerance_m_s = 0.03;
constexpr double kRounding_m_s = 1e-9;

/// The steps from the last one that landed at or before a time; empty when there is none.
std::span<const log::Step> from_last_before(std::span<const log::Step> steps, double time_s) {
  const auto after =
      std::ranges::find_if(steps, [=](const log::Step& step) { return step.time_s > time_s + kTimeSlack_s; });
  const auto before = static_cast<std::size_t>(after - steps.begin());
  return before == 0 ? std::span<const log::Step>() : steps.subspan(before - 1);
}

}  // namespace

std::optional<StepRange> step_range(std::span<const log::Step> steps, double from_s) {
  std::optional<StepRange> range;
  for (const log::Step& step : steps) {
    if (step.time_s < from_s - kTimeSlack_s) continue;
    if (!range) range = {step.length_m, step.length_m};
    range->min_m = std::min(range->min_m, step.length_m);
    range->max_m = std::max(range->max_m, step.length_m);
  }
  return range;
}

std::optional<double> mean_step_m(std::span<const log::Step> steps, std::string_view foot, double from_s) {
  double sum_m = 0.0;
  int count = 0;
  for (const log::Step& step : steps) {
    if (step.foot != foot || step.time_s < from_s - kTimeSlack_s) continue;
    sum_m += step.length_m;
    ++count;
  }
  return count > 0 ? std::optional(sum_m / count) : std::nullopt;
}

std::optional<int> recovery_steps(std::span<const log::Step> steps, double push_end_s,
                                  double unpushed_speed_m_s) {
  const double tolerance_m_s =
      std::max(kShare * std::abs(unpushed_speed_m_s), kLeastTolerance_m_s) + kRounding_m_s;
  const std::span<const log::Step> left = from_last_before(steps, push_end_s);
  int in_a_row = 0;
  for (std::size_t n = 0; n + kStride < left.size(); ++n) {
    const log::Step &first = left[n], &last = left[n + kStride];
    const double speed_m_s = (last.hip_x_m - first.hip_x_m) / (last.time_s - first.time_s);
    in_a_row = std::abs(speed_m_s - unpushed_speed_m_s) <= tolerance_m_s ? in_a_row + 1 : 0;
    if (in_a_row == kStays) return static_cast<int>(n) - kStays + 1;
  }
  return std::nullopt;
}

}  // namespace stilt::experiments
