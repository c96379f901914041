#include "host_tools/simulation/plant/stance.h"

#include <cmath>
#include <stdexcept>

#include "host_tools/simulation/plant/number.h"

namespace stilt::simulation {

LegAngles leg_angles(const LegLengths& leg, double forward_m, double below_m, double pitch_rad) {
  const double distance_m = std::hypot(forward_m, below_m);
  if (distance_m > leg.thigh_m + leg.shin_m || distance_m < std::abs(leg.thigh_m - leg.shin_m)) {
    throw std::invalid_argument("a foot " + number_text(forward_m) + " m ahead of the hip and " +
                                number_text(below_m) + " m below it is out of reach of a leg of " +
                                number_text(leg.thigh_m) + " m and " + number_text(leg.shin_m) + " m");
  }
  const double cosine = (distance_m * distance_m - leg.thigh_m * leg.thigh_m - leg.shin_m * leg.shin_m) /
                        (2.0 * leg.thigh_m * leg.shin_m);
  const double knee_rad = std::acos(std::fmin(1.0, std::fmax(-1.0, cosine)));
  const double line_rad = std::atan2(-forward_m, below_m);
  const double thigh_to_line_rad =
      std::atan2(leg.shin_m * std::sin(knee_rad), leg.thigh_m + leg.shin_m * std::cos(knee_rad));
  return {line_rad - thigh_to_line_rad - pitch_rad, knee_rad};
}

model::FeetVector foot_positions(const LegLengths& leg, const model::StateVector& state) {
  model::FeetVector feet;
  for (int foot = 0; foot < model::kFeet; ++foot) {
    const double thigh_rad = state[model::kFirstAngle] + state[model::kFirstJoint + 2 * foot];
    const double shin_rad = thigh_rad + state[model::kFirstJoint + 2 * foot + 1];
    feet[2 * foot] = state[0] - leg.thigh_m * std::sin(thigh_rad) - leg.shin_m * std::sin(shin_rad);
    feet[2 * foot + 1] = state[1] - leg.thigh_m * std::cos(thigh_rad) - leg.shin_m * std::cos(shin_rad);
  }
  return feet;
}

model::StateVector standing_state(const LegLengths& leg, double base_height_m, double half_width_m,
                                  const std::array<double, model::kFeet>& ground_height_m) {
  const LegAngles left = leg_angles(leg, half_width_m, base_height_m - ground_height_m[model::kLeft], 0.0);
  const LegAngles right = leg_angles(leg, -half_width_m, base_height_m - ground_height_m[model::kRight], 0.0);
  model::StateVector state = model::StateVector::Zero();
  state[1] = base_height_m;
  state[3] = left.hip_rad;
  state[4] = left.knee_rad;
  state[5] = right.hip_rad;
  state[6] = right.knee_rad;
  return state;
}

}  // namespace stilt::simulation
