#include "host_tools/experiments/postures.h"

#include <algorithm>
#include <cmath>

namespace stilt::experiments {

Posture posture_of(const log::RobotDrawing& robot, const model::StateVector& state) {
  Posture posture{state[0], state[1], state[2], {}, {}, {}, {}};
  for (int leg = 0; leg < model::kFeet; ++leg) {
    const double thigh = state[2] + state[model::kFirstJoint + 2 * leg];
    const double shin = thigh + state[model::kFirstJoint + 2 * leg + 1];
    posture.knee_x_m[leg] = state[0] - robot.thigh_length_m * std::sin(thigh);
    posture.knee_z_m[leg] = state[1] - robot.thigh_length_m * std::cos(thigh);
    posture.foot_x_m[leg] = posture.knee_x_m[leg] - robot.shin_length_m * std::sin(shin);
    posture.foot_z_m[leg] = posture.knee_z_m[leg] - robot.shin_length_m * std::cos(shin);
  }
  return posture;
}

Posture end_posture(const log::RobotDrawing& robot, const log::PlanSnapshot& plan) {
  Posture posture{plan.base_x_m.back(), plan.base_z_m.back(), plan.pitch_rad.back(), {}, {}, {}, {}};
  const model::FeetVector& feet = plan.foot_position_m.back();
  for (int leg = 0; leg < model::kFeet; ++leg) {
    const double x_m = feet[2 * leg] - posture.hip_x_m;
    const double z_m = feet[2 * leg + 1] - posture.hip_z_m;
    const double reach_m = std::hypot(x_m, z_m);
    const double a = robot.thigh_length_m;
    const double b = robot.shin_length_m;
    // The knee lies along the line from hip to foot, and ahead of it (the shin swings backward).
    const double along_m = (a * a - b * b + reach_m * reach_m) / (2.0 * reach_m);
    const double aside_m = std::sqrt(std::max(0.0, a * a - along_m * along_m));
    posture.knee_x_m[leg] = posture.hip_x_m + (along_m * x_m - aside_m * z_m) / reach_m;
    posture.knee_z_m[leg] = posture.hip_z_m + (along_m * z_m + aside_m * x_m) / reach_m;
    posture.foot_x_m[leg] = feet[2 * leg];
    posture.foot_z_m[leg] = feet[2 * leg + 1];
  }
  return posture;
}

void draw(const log::RobotDrawing& robot, const Posture& posture, double shift_m, plot::Plot& figure) {
  constexpr const char* kColours[model::kFeet] = {"var(--a)", "var(--c)"};
  const double hip_m = posture.hip_x_m + shift_m;
  for (int leg = 0; leg < model::kFeet; ++leg) {
    figure.curves.push_back({"",
                             kColours[leg],
                             {hip_m, posture.knee_x_m[leg] + shift_m, posture.foot_x_m[leg] + shift_m},
                             {posture.hip_z_m, posture.knee_z_m[leg], posture.foot_z_m[leg]}});
  }
  figure.curves.push_back(
      {"",
       "var(--text)",
       {hip_m, hip_m + robot.torso_length_m * std::sin(posture.pitch_rad)},
       {posture.hip_z_m, posture.hip_z_m + robot.torso_length_m * std::cos(posture.pitch_rad)}});
}

}  // namespace stilt::experiments
