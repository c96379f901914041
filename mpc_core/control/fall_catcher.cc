#include "mpc_core/control/fall_catcher.h"

#include <algorithm>
#include <cmath>

namespace stilt::control {
namespace {

gait::Fall predicted_fall(const model::StateVector& state, const model::FeetVector& feet,
                          double margin_m) noexcept {
  const double height_m = std::max(state[1], 0.0);
  const double capture_x_m = state[0] + state[model::kPositions] * std::sqrt(height_m / model::kGravity_m_s2);
  if (capture_x_m > std::max(feet[0], feet[2]) - margin_m) return gait::Fall::forward;
  if (capture_x_m < std::min(feet[0], feet[2]) + margin_m) return gait::Fall::backward;
  return gait::Fall::none;
}

}  // namespace

gait::GaitCommand FallCatcher::update(double time_s, const gait::GaitCommand& command, double standing_s,
                                      const model::StateVector& state, const model::FeetVector& feet,
                                      const gait::GaitParameters& parameters) noexcept {
  if (!parameters.catch_falls || command.kind != gait::GaitKind::stand) {
    reset();
    return command;
  }
  // The estimate needs a moment after a landing.
  constexpr double kSettled_s = 0.06;
  if (fall_ == gait::Fall::none && standing_s > kSettled_s) {
    fall_ = predicted_fall(state, feet, parameters.catch_margin_m);
    moving_until_s_ = time_s;
  }
  if (fall_ == gait::Fall::none) return command;
  if (std::abs(state[model::kPositions]) > parameters.catch_calm_m_s) moving_until_s_ = time_s;
  const double step_s = parameters.single_support_s + parameters.double_support_s;
  if (time_s - moving_until_s_ > step_s) {
    reset();
    return command;
  }
  return {gait::GaitKind::step, 0.0};
}

}  // namespace stilt::control
