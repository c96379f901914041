// A torque stays bounded whatever is not a number.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "tests/mpc_core/control/torque_law_rig.h"

namespace stilt::control {
namespace {

using model::kInputs;
using model::kJoints;
using model::kStates;
using testing_support::reading_of;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST_F(TorqueLawTest, ANonFiniteSensorGivesBoundedTorqueAndItsName) {
  configure(shipped("amber3m"));
  const auto spoil = [](SensorReading& reading, int field, double value) {
    if (field < 4) reading.joint_position_rad[field] = value;
    if (field >= 4 && field < 8) reading.joint_velocity_rad_s[field - 4] = value;
    if (field == 8) reading.base_pitch_rad = value;
    if (field == 9) reading.base_pitch_rate_rad_s = value;
    if (field == 10) reading.time_s = value;
  };
  for (const double speed_rad_s : {1.0, 1e6}) {  // so fast that damping reaches the limit
    state_.tail<kJoints>().setConstant(speed_rad_s);
    for (int field = 0; field < 11; ++field) {
      for (const double value : {kNan, kInfinity, -kInfinity}) {
        SensorReading reading = reading_of(state_, kNow_s);
        spoil(reading, field, value);
        const std::string what = "field " + std::to_string(field) + " is " + std::to_string(value);
        const TorqueCommand command = follow(reading, state_);
        EXPECT_FALSE(command.finite) << what;
        expect_safe(command, what);
      }
    }
  }
}

TEST_F(TorqueLawTest, WithOneVelocityMissingTheOtherJointsAreDamped) {
  configure(shipped("amber3m"));
  SensorReading reading = reading_of(state_, kNow_s);
  reading.joint_velocity_rad_s[1] = kNan;
  const TorqueCommand command = follow(reading, state_);
  const double kd = parameters_.torque_law.joint_kd_Nms_rad;
  for (const int j : {0, 2, 3}) EXPECT_EQ(command.torque_Nm[j], -kd * reading.joint_velocity_rad_s[j]);
  EXPECT_EQ(command.torque_Nm[1], 0.0);
}

TEST_F(TorqueLawTest, ANonFiniteStateGivesBoundedTorqueAndItsName) {
  configure(shipped("amber3m"));
  for (int i = 0; i < kStates; ++i) {
    model::StateVector state = state_;
    state[i] = kNan;
    const TorqueCommand command = follow(reading_of(state_, kNow_s), state);
    EXPECT_FALSE(command.finite);
    expect_safe(command, "state " + std::to_string(i));
  }
}

TEST_F(TorqueLawTest, ANonFinitePlanGivesBoundedTorque) {
  ControllerParameters parameters = shipped("amber3m");
  use_feedback(parameters);
  configure(parameters);
  for (int k = 0; k < plan_->nodes; ++k) {
    for (const double value : {kNan, kInfinity, -kInfinity}) {
      const auto spoiled = [&](const std::function<void(PlanNode&)>& spoil) {
        const PlanNode kept = plan_->node[static_cast<std::size_t>(k)];
        spoil(plan_->node[static_cast<std::size_t>(k)]);
        expect_safe(tick(), "node " + std::to_string(k));
        plan_->node[static_cast<std::size_t>(k)] = kept;
      };
      spoiled([&](PlanNode& node) { node.time_s = value; });
      for (int i = 0; i < kStates; ++i) spoiled([&](PlanNode& node) { node.state[i] = value; });
      for (int i = 0; i < kInputs; ++i) spoiled([&](PlanNode& node) { node.input[i] = value; });
      spoiled([&](PlanNode& node) { node.gain.setConstant(value); });
    }
  }
}

TEST_F(TorqueLawTest, ANonFinitePlanIsNamedWhereverItReachesTheTorque) {
  ControllerParameters parameters = shipped("amber3m");
  use_feedback(parameters);
  configure(parameters);
  PlanNode& node = plan_->node[1];  // active at kNow_s
  const PlanNode kept = node;
  const auto expect_named = [&](const std::string& what) {
    const TorqueCommand command = tick();
    EXPECT_FALSE(command.finite) << what;
    expect_damping(command);
    node = kept;
  };
  for (int i = 0; i < kStates; ++i) {
    node.state[i] = kNan;
    expect_named("state " + std::to_string(i));
  }
  for (int i = 0; i < kInputs; ++i) {
    node.input[i] = kNan;
    expect_named("input " + std::to_string(i));
  }
  node.gain(0, 0) = kNan;
  expect_named("gain");
}

}  // namespace
}  // namespace stilt::control
