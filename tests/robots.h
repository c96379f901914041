#pragma once

#include <algorithm>
#include <string_view>

#include "mpc_core/model/robot.h"

/// The shipped robots as numbers, for tests that have no URDF reader. A test compares them with the URDFs
/// (tests/firmware/robots/robots_test.cc).
namespace stilt::testing_support {

/// What the shipped robots have in common: hips 1.6 rad either way, knees 0 to 2.4 rad, 10 rad/s, no damping.
inline model::RobotModel shipped_robot(const char* name, const double (&numbers)[model::kNumbers],
                                       double torque_limit_Nm, double gear_ratio,
                                       double rotor_inertia_kg_m2) {
  model::RobotConstants constants{};
  constants.name = name;
  std::ranges::copy(numbers, constants.numbers);
  for (int j = 0; j < model::kJoints; ++j) {
    const bool hip = j % 2 == 0;
    constants.position_min_rad[j] = hip ? -1.6 : 0.0;
    constants.position_max_rad[j] = hip ? 1.6 : 2.4;
    constants.velocity_limit_rad_s[j] = 10.0;
    constants.torque_limit_Nm[j] = torque_limit_Nm;
    constants.joint_parameters[j] = gear_ratio * gear_ratio * rotor_inertia_kg_m2;
  }
  return model::make_robot(constants);
}

inline const model::RobotModel& amber3m() {
  static const model::RobotModel robot = shipped_robot(
      "amber3m", {13.0, 0.21483, 0.1940, 3.4261, 0.1494, 0.0389, 0.4064, 0.85216, 0.171885, 0.019286, 0.4667},
      80.0, 91.4286, 5.1e-5);
  return robot;
}

/// AMBER-3M with the other published centre of mass of the torso.
inline const model::RobotModel& amber3m_2020() {
  static const model::RobotModel robot = shipped_robot(
      "amber3m_2020",
      {13.0, 0.28507, 0.1940, 3.4261, 0.1494, 0.0389, 0.4064, 0.85216, 0.171885, 0.019286, 0.4667}, 80.0,
      91.4286, 5.1e-5);
  return robot;
}

inline const model::RobotModel& rabbit() {
  static const model::RobotModel robot = shipped_robot(
      "rabbit", {12.0, 0.24, 1.33, 6.8, 0.11, 0.47, 0.4, 3.2, 0.24, 0.20, 0.4}, 150.0, 50.0, 3.32e-4);
  return robot;
}

/// The robot of that name, or nullptr.
inline const model::RobotModel* find_robot(std::string_view name) {
  for (const model::RobotModel* robot : {&amber3m(), &amber3m_2020(), &rabbit()}) {
    if (name == robot->constants.name) return robot;
  }
  return nullptr;
}

}  // namespace stilt::testing_support
