#include "mpc_core/control/torque_law.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "firmware/configuration/configuration.h"
#include "host_tools/simulator/simulated_robot.h"
#include "tests/codegen/model/mujoco_robot.h"
#include "tests/mpc_core/control/sample_plan.h"

namespace stilt::control {
namespace {

using model::JointVector;
using model::kFirstJoint;
using model::kInputs;
using model::kJoints;
using model::kPositions;
using model::kStates;
using testing_support::kPlanEnd_s;
using testing_support::random_input;
using testing_support::random_state;
using testing_support::reading_of;
using testing_support::sample_plan;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNow_s = 1.02;

ControllerParameters shipped(const char* robot) { return configuration::load_robot(robot).value(); }

/// Joint limits out of the way, so that torques can be compared.
ControllerParameters unlimited(const char* robot) {
  ControllerParameters parameters = shipped(robot);
  parameters.robot.torque_limit_scale = 1e6;
  return parameters;
}

class TorqueLoopTest : public ::testing::Test {
 protected:
  void configure(const ControllerParameters& parameters) {
    parameters_ = parameters;
    loop_.configure(robot_, parameters);
    loop_.reset(reading_of(state_, kNow_s), 0.0);
  }

  TorqueCommand tick(double time_s = kNow_s) {
    return loop_.tick_with_state(reading_of(state_, time_s), state_, *plan_);
  }

  [[nodiscard]] double limit_Nm(int joint) const {
    return parameters_.robot.torque_limit_scale * robot_.constants.torque_limit_Nm[joint];
  }

  void expect_safe(const TorqueCommand& command, const std::string& what) const {
    for (int j = 0; j < kJoints; ++j) {
      EXPECT_TRUE(std::isfinite(command.torque_Nm[j])) << what << ", joint " << j;
      EXPECT_LE(std::abs(command.torque_Nm[j]), limit_Nm(j)) << what << ", joint " << j;
    }
  }

  void expect_damping(const TorqueCommand& command) const {
    for (int j = 0; j < kJoints; ++j) {
      EXPECT_EQ(command.torque_Nm[j],
                -parameters_.torque_law.joint_kd_Nms_rad * state_[kPositions + kFirstJoint + j]);
    }
  }

  model::RobotModel robot_ = model::amber3m();
  std::mt19937_64 random_{20240611};
  model::StateVector state_ = random_state(random_);
  std::unique_ptr<Plan> plan_ = sample_plan(11);
  ControllerParameters parameters_;
  TorqueLoop loop_;
};

TEST_F(TorqueLoopTest, WithoutAPlanTheJointsAreDamped) {
  configure(shipped("amber3m"));
  plan_->nodes = 0;
  const TorqueCommand command = tick();
  EXPECT_EQ(command.status, TorqueStatus::damping_no_plan);
  EXPECT_FALSE(command.saturated);
  expect_damping(command);
}

TEST_F(TorqueLoopTest, APlanOfOneNodeIsNoPlan) {
  configure(shipped("amber3m"));
  plan_->nodes = 1;
  EXPECT_EQ(tick().status, TorqueStatus::damping_no_plan);
}

TEST_F(TorqueLoopTest, AStalePlanDampsTheJoints) {
  configure(shipped("amber3m"));
  EXPECT_EQ(tick(kPlanEnd_s).status, TorqueStatus::tracking);
  const TorqueCommand command = tick(kPlanEnd_s + 1e-6);
  EXPECT_EQ(command.status, TorqueStatus::damping_stale_plan);
  expect_damping(command);
}

TEST_F(TorqueLoopTest, ANonFiniteSensorGivesBoundedTorqueAndItsName) {
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
        for (const TorqueCommand& command :
             {loop_.tick(reading, *plan_), loop_.tick_with_state(reading, state_, *plan_)}) {
          EXPECT_EQ(command.status, TorqueStatus::damping_not_finite) << what;
          expect_safe(command, what);
        }
      }
    }
  }
}

TEST_F(TorqueLoopTest, WithOneVelocityMissingTheOtherJointsAreDamped) {
  configure(shipped("amber3m"));
  SensorReading reading = reading_of(state_, kNow_s);
  reading.joint_velocity_rad_s[1] = kNan;
  const TorqueCommand command = loop_.tick(reading, *plan_);
  const double kd = parameters_.torque_law.joint_kd_Nms_rad;
  for (const int j : {0, 2, 3}) EXPECT_EQ(command.torque_Nm[j], -kd * reading.joint_velocity_rad_s[j]);
  EXPECT_EQ(command.torque_Nm[1], 0.0);
}

TEST_F(TorqueLoopTest, ANonFiniteSensorYieldsNoStateToPlanFrom) {
  configure(shipped("amber3m"));
  SensorReading reading = reading_of(state_, kNow_s);
  reading.base_pitch_rad = kNan;
  EXPECT_FALSE(loop_.tick(reading, *plan_).estimated_state.allFinite());
}

TEST_F(TorqueLoopTest, ANonFiniteStateGivesBoundedTorqueAndItsName) {
  configure(shipped("amber3m"));
  for (int i = 0; i < kStates; ++i) {
    model::StateVector state = state_;
    state[i] = kNan;
    const TorqueCommand command = loop_.tick_with_state(reading_of(state_, kNow_s), state, *plan_);
    EXPECT_EQ(command.status, TorqueStatus::damping_not_finite);
    expect_safe(command, "state " + std::to_string(i));
  }
}

TEST_F(TorqueLoopTest, AGoodReadingAfterABadOneIsAsIfTheBadOneHadNotBeen) {
  configure(shipped("amber3m"));
  TorqueLoop untouched = loop_;
  SensorReading bad = reading_of(state_, kNow_s);
  bad.joint_position_rad[2] = kNan;
  (void)loop_.tick(bad, *plan_);
  const TorqueCommand command = loop_.tick(reading_of(state_, kNow_s + 0.001), *plan_);
  const TorqueCommand expected = untouched.tick(reading_of(state_, kNow_s + 0.001), *plan_);
  EXPECT_EQ(command.status, TorqueStatus::tracking);
  EXPECT_TRUE(command.torque_Nm == expected.torque_Nm);
  EXPECT_TRUE(command.estimated_state == expected.estimated_state);
}

TEST_F(TorqueLoopTest, ANonFinitePlanGivesBoundedTorque) {
  ControllerParameters parameters = shipped("amber3m");
  parameters.torque_law.use_feedback_gains = true;
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

TEST_F(TorqueLoopTest, ANonFinitePlanIsNamedWhereverItReachesTheTorque) {
  ControllerParameters parameters = shipped("amber3m");
  parameters.torque_law.use_feedback_gains = true;
  configure(parameters);
  PlanNode& node = plan_->node[1];  // in force at kNow_s
  const PlanNode kept = node;
  const auto expect_named = [&](const std::string& what) {
    const TorqueCommand command = tick();
    EXPECT_EQ(command.status, TorqueStatus::damping_not_finite) << what;
    expect_damping(command);
    EXPECT_TRUE(command.estimated_state == state_) << "the state is good, only the plan is not";
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

TEST_F(TorqueLoopTest, TorqueNeverExceedsTheLimitOfItsJoint) {
  for (const double scale : {1.0, 0.5}) {
    ControllerParameters parameters = shipped("amber3m");
    parameters.robot.torque_limit_scale = scale;
    configure(parameters);
    for (int j = 0; j < kJoints; ++j) {
      for (const double side : {-1.0, 1.0}) {
        state_ = plan_->node[1].state;
        state_[kFirstJoint + j] -= side * 100.0;
        const TorqueCommand command = tick();
        EXPECT_EQ(command.torque_Nm[j], side * limit_Nm(j)) << "joint " << j;
        EXPECT_TRUE(command.saturated);
        expect_safe(command, "joint " + std::to_string(j));
      }
    }
  }
}

TEST_F(TorqueLoopTest, DampingIsLimitedToo) {
  configure(shipped("amber3m"));
  plan_->nodes = 0;
  state_.tail<kJoints>().setConstant(1e6);
  const TorqueCommand command = tick();
  EXPECT_TRUE(command.saturated);
  for (int j = 0; j < kJoints; ++j) EXPECT_EQ(command.torque_Nm[j], -limit_Nm(j));
}

TEST_F(TorqueLoopTest, TorqueThatDrivesTheMotionFallsLinearlyToNothingAtTheNoLoadSpeed) {
  ControllerParameters parameters = shipped("amber3m");
  parameters.robot.no_load_speed_rad_s = 10.0;
  configure(parameters);
  plan_->node[1].input.setZero();
  struct Case {
    double velocity_rad_s;
    double pull;   // which way a large position error pulls
    double share;  // of the limit at standstill
  };
  for (const Case& c : {Case{0.0, 1.0, 1.0}, Case{4.0, 1.0, 0.6}, Case{-4.0, -1.0, 0.6}, Case{4.0, -1.0, 1.0},
                        Case{-4.0, 1.0, 1.0}, Case{10.0, 1.0, 0.0}, Case{12.0, 1.0, 0.0}}) {
    for (int j = 0; j < kJoints; ++j) {
      state_ = plan_->node[1].state;
      state_[kFirstJoint + j] -= c.pull * 100.0;
      state_[kPositions + kFirstJoint + j] = c.velocity_rad_s;
      const TorqueCommand command = tick();
      EXPECT_NEAR(command.torque_Nm[j], c.pull * c.share * limit_Nm(j), 1e-9)
          << "joint " << j << " at " << c.velocity_rad_s << " rad/s";
      EXPECT_TRUE(command.saturated);
    }
  }
}

TEST_F(TorqueLoopTest, JointDampingOfTheConfigurationIsPartOfTheFeedForwardTorque) {
  ControllerParameters parameters = unlimited("amber3m");
  configure(parameters);
  const JointVector without_Nm = tick().torque_Nm;
  parameters.robot.hip_damping_Nms_rad = 1.5;
  parameters.robot.knee_damping_Nms_rad = 0.5;
  configure(parameters);
  const JointVector more_Nm = tick().torque_Nm - without_Nm;
  const model::StateVector planned = interpolate(*plan_, kNow_s).state;
  for (int j = 0; j < kJoints; ++j) {
    const double damping = j % 2 == 0 ? 1.5 : 0.5;
    EXPECT_NEAR(more_Nm[j], damping * planned[kPositions + kFirstJoint + j], 1e-9) << "joint " << j;
  }
}

TEST_F(TorqueLoopTest, PositionAndVelocityErrorsPullBackByTheGains) {
  configure(unlimited("amber3m"));
  state_ = interpolate(*plan_, kNow_s).state;
  const JointVector at_plan_Nm = tick().torque_Nm;
  for (int j = 0; j < kJoints; ++j) {
    state_[kFirstJoint + j] += 0.01;
    EXPECT_NEAR(tick().torque_Nm[j] - at_plan_Nm[j], -0.01 * parameters_.torque_law.joint_kp_Nm_rad, 1e-9);
    state_[kFirstJoint + j] -= 0.01;
    state_[kPositions + kFirstJoint + j] += 0.01;
    EXPECT_NEAR(tick().torque_Nm[j] - at_plan_Nm[j], -0.01 * parameters_.torque_law.joint_kd_Nms_rad, 1e-9);
    state_[kPositions + kFirstJoint + j] -= 0.01;
  }
}

TEST_F(TorqueLoopTest, FrictionCompensationHelpsThePlannedMotion) {
  ControllerParameters parameters = unlimited("amber3m");
  parameters.robot.hip_coulomb_friction_Nm = 2.0;
  parameters.robot.knee_coulomb_friction_Nm = 3.0;
  parameters.torque_law.friction_compensation = 0.0;
  configure(parameters);
  const JointVector without_Nm = tick().torque_Nm;
  parameters.torque_law.friction_compensation = 0.7;
  configure(parameters);
  const JointVector share_Nm = tick().torque_Nm - without_Nm;
  const model::StateVector planned = interpolate(*plan_, kNow_s).state;
  for (int j = 0; j < kJoints; ++j) {
    const double velocity = planned[kPositions + kFirstJoint + j];
    EXPECT_GT(share_Nm[j] * velocity, 0.0) << "joint " << j;
    const double friction_Nm = j % 2 == 0 ? 2.0 : 3.0;
    EXPECT_NEAR(share_Nm[j],
                0.7 * friction_Nm * std::tanh(velocity / parameters.torque_law.friction_velocity_rad_s),
                1e-9);
  }
}

TEST_F(TorqueLoopTest, FeedbackGainsActOnlyWhenTheyAreOn) {
  ControllerParameters parameters = unlimited("amber3m");
  parameters.torque_law.use_feedback_gains = false;
  configure(parameters);
  const JointVector off_Nm = tick().torque_Nm;
  for (PlanNode& node : plan_->node) node.gain *= 3.0;
  EXPECT_TRUE(tick().torque_Nm == off_Nm);

  parameters.torque_law.use_feedback_gains = true;
  configure(parameters);
  const JointVector on_Nm = tick().torque_Nm;
  // The same inputs as an open-loop plan: kNow_s lies in an interval that holds them.
  const PlanPoint point = interpolate(*plan_, kNow_s);
  plan_->node[1].input += *point.gain * (state_ - point.state);
  parameters.torque_law.use_feedback_gains = false;
  configure(parameters);
  EXPECT_LT((tick().torque_Nm - on_Nm).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_GT((on_Nm - off_Nm).cwiseAbs().maxCoeff(), 0.1);
}

TEST_F(TorqueLoopTest, TheEstimatorsStateIsTheOneTracked) {
  configure(shipped("amber3m"));
  TorqueLoop other = loop_;
  const TorqueCommand estimated = loop_.tick(reading_of(state_, kNow_s), *plan_);
  const TorqueCommand given =
      other.tick_with_state(reading_of(state_, kNow_s), estimated.estimated_state, *plan_);
  EXPECT_EQ(estimated.status, TorqueStatus::tracking);
  EXPECT_TRUE(estimated.torque_Nm == given.torque_Nm);
}

class FeedForwardTest : public ::testing::TestWithParam<const char*> {};

/// MuJoCo, given the torque and the planned contact forces, accelerates the joints as planned.
TEST_P(FeedForwardTest, TorqueGivesThePlannedJointAccelerations) {
  constexpr std::uint64_t kSeed = 5;
  std::mt19937_64 random(kSeed);
  const model::RobotModel& robot = *model::find_robot(GetParam());
  for (const double armature_scale : {1.0, 0.0}) {
    ControllerParameters parameters = unlimited(GetParam());
    parameters.robot.armature_scale = armature_scale;
    parameters.torque_law.friction_compensation = 0.0;
    TorqueLoop loop;
    loop.configure(robot, parameters);
    testing_support::MujocoRobot mujoco(simulator::simulated_robot(GetParam()));
    for (int j = 0; j < kJoints; ++j) {
      mujoco.set_joint(j, armature_scale * robot.constants.joint_parameters[j],
                       robot.constants.joint_parameters[kJoints + j]);
    }
    const auto plan = sample_plan(kSeed);
    for (int trial = 0; trial < 200; ++trial) {
      plan->node[1].state = random_state(random);
      plan->node[1].input = random_input(random);
      const model::StateVector& state = plan->node[1].state;
      const SensorReading reading = reading_of(state, plan->node[1].time_s);
      const TorqueCommand command = loop.tick_with_state(reading, state, *plan);
      ASSERT_EQ(command.status, TorqueStatus::tracking);
      mujoco.forward(state.data(), command.torque_Nm.data(), plan->node[1].input.data() + kJoints);
      for (int j = 0; j < kJoints; ++j) {
        EXPECT_NEAR(mujoco.acceleration()[kFirstJoint + j], plan->node[1].input[j], 1e-8)
            << "seed " << kSeed << ", trial " << trial << ", joint " << j;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, FeedForwardTest, ::testing::Values("amber3m", "rabbit"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace stilt::control
