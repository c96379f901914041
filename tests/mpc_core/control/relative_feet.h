#pragma once

#include "mpc_core/model/robot.h"

namespace stilt::testing_support {

/// Foot positions and velocities relative to a base at the origin, as the estimator gets them.
struct RelativeFeet {
  explicit RelativeFeet(const model::RobotModel& robot, model::StateVector state) {
    state[0] = state[1] = state[model::kPositions] = state[model::kPositions + 1] = 0.0;
    robot.kinematics(state.data(), terms);
  }
  /// Base velocity if that foot stands still.
  [[nodiscard]] double vx_m_s(int foot) const { return -terms.foot_velocity[2 * foot]; }
  [[nodiscard]] double vz_m_s(int foot) const { return -terms.foot_velocity[2 * foot + 1]; }
  [[nodiscard]] double height_m(int foot) const { return -terms.foot_position[2 * foot + 1]; }
  [[nodiscard]] double x_m(int foot) const { return terms.foot_position[2 * foot]; }

  model::KinematicsTerms<double> terms;
};

}  // namespace stilt::testing_support
