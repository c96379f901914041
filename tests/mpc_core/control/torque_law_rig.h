#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <string>

#include "firmware/configuration/configuration.h"
#include "mpc_core/control/torque_law.h"
#include "tests/mpc_core/control/sample_plan.h"
#include "tests/robots.h"

namespace stilt::control {

inline constexpr double kNow_s = 1.02;

[[nodiscard]] inline ControllerParameters shipped(const char* robot) {
  return configuration::load_robot(robot).value();
}

/// Joint limits and feedback gains out of the way, so that torques can be compared.
[[nodiscard]] inline ControllerParameters unlimited(const char* robot) {
  ControllerParameters parameters = shipped(robot);
  parameters.robot.torque_limit_scale = 1e6;
  parameters.torque_law.use_feedback_gains = false;
  return parameters;
}

/// All of the gains act on the sample plan, which is 20 ms old at kNow_s.
inline void use_feedback(ControllerParameters& parameters) {
  parameters.torque_law.use_feedback_gains = true;
  parameters.torque_law.feedback_from_age_s = 0.008;
  parameters.torque_law.feedback_full_age_s = 0.016;
}

class TorqueLawTest : public ::testing::Test {
 protected:
  void configure(const ControllerParameters& parameters) {
    parameters_ = parameters;
    law_.configure(robot_, parameters);
  }

  TorqueCommand tick(double time_s = kNow_s) {
    return follow(testing_support::reading_of(state_, time_s), state_);
  }

  [[nodiscard]] TorqueCommand follow(const SensorReading& reading, const model::StateVector& state) const {
    return law_.follow(reading, state, interpolate(*plan_, kNow_s));
  }

  [[nodiscard]] double limit_Nm(int joint) const {
    return parameters_.robot.torque_limit_scale * robot_.constants.torque_limit_Nm[joint];
  }

  void expect_safe(const TorqueCommand& command, const std::string& what) const {
    for (int j = 0; j < model::kJoints; ++j) {
      EXPECT_TRUE(std::isfinite(command.torque_Nm[j])) << what << ", joint " << j;
      EXPECT_LE(std::abs(command.torque_Nm[j]), limit_Nm(j)) << what << ", joint " << j;
    }
  }

  void expect_damping(const TorqueCommand& command) const {
    for (int j = 0; j < model::kJoints; ++j) {
      EXPECT_EQ(command.torque_Nm[j], -parameters_.torque_law.joint_kd_Nms_rad *
                                          state_[model::kPositions + model::kFirstJoint + j]);
    }
  }

  model::RobotModel robot_ = testing_support::amber3m();
  std::mt19937_64 random_{20240611};
  model::StateVector state_ = testing_support::random_state(random_);
  std::unique_ptr<Plan> plan_ = testing_support::sample_plan(11);
  ControllerParameters parameters_;
  TorqueLaw law_;
};

}  // namespace stilt::control
