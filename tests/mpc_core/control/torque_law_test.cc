#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "firmware/configuration/live.h"
#include "firmware/robots/robots.h"
#include "tests/codegen/model/mujoco_robot.h"
#include "tests/mpc_core/control/torque_law_rig.h"
#include "tests/robots.h"

namespace stilt::control {
namespace {

using model::JointVector;
using model::kFirstJoint;
using model::kJoints;
using model::kPositions;
using testing_support::random_input;
using testing_support::random_state;
using testing_support::reading_of;
using testing_support::sample_plan;

TEST_F(TorqueLawTest, TorqueNeverExceedsTheLimitOfItsJoint) {
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
        expect_safe(command, "joint " + std::to_string(j));
      }
    }
  }
}

/// Every live key of the section, by its table.
TEST_F(TorqueLawTest, TunedLiveItGivesTheTorquesOfALawConfiguredSo) {
  configuration::Configuration base = configuration::load_robot("amber3m").value();
  base.robot.torque_limit_scale = 1e6;
  base.robot.hip_coulomb_friction_Nm = 2.0;
  for (PlanNode& node : plan_->node) {  // the least normal force of one foot acts
    node.mode = {true, false};
    node.input.tail<4>() << 0.0, 1.0, 0.0, 0.0;
  }
  configure(base);
  const JointVector before_Nm = tick().torque_Nm;
  int keys = 0;
  for (const configuration::LiveTunable& tunable : configuration::live_tunables(base)) {
    if (tunable.entry->section != "torque_law") continue;
    ++keys;
    configuration::Configuration changed = base;
    std::get<configuration::RealField>(tunable.entry->field).set(changed, tunable.minimum);
    configure(changed);
    const JointVector configured_Nm = tick().torque_Nm;
    configure(base);
    law_.tune(changed.torque_law);
    EXPECT_EQ(tick().torque_Nm, configured_Nm) << tunable.entry->name();
    EXPECT_NE(configured_Nm, before_Nm) << tunable.entry->name();
  }
  EXPECT_EQ(keys, 4);
}

/// Torque of the plan with the contact forces of node 1 replaced.
TEST_F(TorqueLawTest, ContactForcesOutsideTheConeActAsTheNearestOnesWithTheSameNormalForce) {
  configure(unlimited("amber3m"));
  PlanNode& node = plan_->node[1];
  node.mode = {true, false};
  plan_->node[2] = node;  // held over the interval
  plan_->node[2].time_s = 2.0;
  const double mu = parameters_.inequality.friction_coefficient;
  const double minimum_N = parameters_.torque_law.minimum_normal_force_share *
                           robot_.constants.total_mass_kg * model::kGravity_m_s2;
  const auto torque = [&](double fx_N, double fz_N, double swing_N) {
    for (PlanNode* at : {&node, &plan_->node[2]}) {
      at->input.tail<4>() << fx_N, fz_N, swing_N, swing_N;
    }
    return tick().torque_Nm;
  };
  const auto expect_same = [&](const JointVector& a, const JointVector& b, const char* what) {
    EXPECT_LT((a - b).norm(), 1e-9 * (1.0 + b.norm())) << what;
  };
  expect_same(torque(20.0, -900.0, 0.0), torque(20.0, minimum_N, 0.0), "pulling");
  expect_same(torque(20.0, 0.5 * minimum_N, 0.0), torque(20.0, minimum_N, 0.0), "below the least force");
  expect_same(torque(900.0, 200.0, 0.0), torque(mu * 200.0, 200.0, 0.0), "sliding forward");
  expect_same(torque(-900.0, 200.0, 0.0), torque(-mu * 200.0, 200.0, 0.0), "sliding backward");
  expect_same(torque(10.0, 200.0, 50.0), torque(10.0, 200.0, 0.0), "a foot in the air");
  EXPECT_GT((torque(50.0, 200.0, 0.0) - torque(20.0, 200.0, 0.0)).norm(), 1.0) << "inside nothing changes";
}

TEST_F(TorqueLawTest, ContactForcesStayInTheConeAfterFeedback) {
  ControllerParameters parameters = unlimited("amber3m");
  use_feedback(parameters);
  configure(parameters);
  PlanNode& node = plan_->node[1];
  node.mode = {true, false};
  node.input.tail<4>() << 0.0, 200.0, 0.0, 0.0;
  node.gain.setZero();
  node.gain(kJoints + 1, 1) = -1e6;  // a hip that is 1 mm high asks for a pull of 1 kN
  plan_->node[2] = node;
  plan_->node[2].time_s = 2.0;
  model::StateVector state = interpolate(*plan_, kNow_s).state;
  state[1] += 1e-3;
  const auto follow_with_gains = [&] {
    return law_.follow(reading_of(state_, kNow_s), state, interpolate(*plan_, kNow_s)).torque_Nm;
  };
  const JointVector pulled = follow_with_gains();
  node.gain(kJoints + 1, 1) = plan_->node[2].gain(kJoints + 1, 1) = -1e7;
  EXPECT_EQ(follow_with_gains(), pulled);
}

TEST_F(TorqueLawTest, DampingIsLimitedToo) {
  configure(shipped("amber3m"));
  plan_->node[1].input[0] = std::numeric_limits<double>::quiet_NaN();
  state_.tail<kJoints>().setConstant(1e6);
  const TorqueCommand command = tick();
  for (int j = 0; j < kJoints; ++j) EXPECT_EQ(command.torque_Nm[j], -limit_Nm(j));
}

TEST_F(TorqueLawTest, TorqueThatDrivesTheMotionFallsLinearlyToNothingAtTheNoLoadSpeed) {
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
      EXPECT_NEAR(tick().torque_Nm[j], c.pull * c.share * limit_Nm(j), 1e-9)
          << "joint " << j << " at " << c.velocity_rad_s << " rad/s";
    }
  }
}

TEST_F(TorqueLawTest, JointDampingOfTheConfigurationIsPartOfTheFeedForwardTorque) {
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

TEST_F(TorqueLawTest, PositionAndVelocityErrorsPullBackByTheGains) {
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

TEST_F(TorqueLawTest, FrictionCompensationHelpsThePlannedMotion) {
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

TEST_F(TorqueLawTest, FeedbackGainsActOnlyWhenTheyAreOn) {
  ControllerParameters parameters = unlimited("amber3m");
  parameters.torque_law.use_feedback_gains = false;
  configure(parameters);
  const JointVector off_Nm = tick().torque_Nm;
  for (PlanNode& node : plan_->node) node.gain *= 3.0;
  EXPECT_TRUE(tick().torque_Nm == off_Nm);

  use_feedback(parameters);
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

TEST_F(TorqueLawTest, TheShareOfTheGainsGrowsWithTheAgeOfThePlan) {
  ControllerParameters parameters = unlimited("amber3m");
  parameters.torque_law.minimum_normal_force_share = 0.0;
  const PlanPoint point = interpolate(*plan_, kNow_s);
  const SensorReading reading = reading_of(state_, kNow_s);
  const auto torque_Nm = [&](bool gains, double age_s) {
    parameters.torque_law.use_feedback_gains = gains;
    configure(parameters);
    PlanPoint aged = point;
    aged.age_s = age_s;
    return law_.follow(reading, state_, aged).torque_Nm;
  };
  const double from_s = parameters.torque_law.feedback_from_age_s;
  const double full_s = parameters.torque_law.feedback_full_age_s;
  const JointVector off_Nm = torque_Nm(false, full_s);
  const JointVector none_Nm = torque_Nm(true, from_s);
  const JointVector all_Nm = torque_Nm(true, full_s);
  EXPECT_TRUE(none_Nm == off_Nm);
  EXPECT_TRUE(torque_Nm(true, 0.5 * from_s) == off_Nm);
  EXPECT_TRUE(torque_Nm(true, 10.0 * full_s) == all_Nm);
  EXPECT_GT((all_Nm - off_Nm).cwiseAbs().maxCoeff(), 0.1);
  // Joint accelerations, which are not bounded, enter the torque linearly; forces stay as they are.
  for (PlanNode& node : plan_->node) node.gain.bottomRows<4>().setZero();
  const JointVector linear_Nm = torque_Nm(true, full_s) - torque_Nm(false, full_s);
  const JointVector quarter_Nm = torque_Nm(true, 0.75 * from_s + 0.25 * full_s) - torque_Nm(false, full_s);
  EXPECT_LT((quarter_Nm - 0.25 * linear_Nm).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_GT(quarter_Nm.cwiseAbs().maxCoeff(), 1e-3);
}

class FeedForwardTest : public ::testing::TestWithParam<const char*> {};

/// MuJoCo, given the torque and the planned contact forces, accelerates the joints as planned.
TEST_P(FeedForwardTest, TorqueGivesThePlannedJointAccelerations) {
  constexpr std::uint64_t kSeed = 5;
  std::mt19937_64 random(kSeed);
  const model::RobotModel& robot = *testing_support::find_robot(GetParam());
  for (const double armature_scale : {1.0, 0.0}) {
    ControllerParameters parameters = unlimited(GetParam());
    parameters.robot.armature_scale = armature_scale;
    parameters.torque_law.friction_compensation = 0.0;
    TorqueLaw law;
    law.configure(robot, parameters);
    testing_support::MujocoRobot mujoco(robots::find(GetParam()).value()->tree);
    for (int j = 0; j < kJoints; ++j) {
      mujoco.set_joint(j, armature_scale * robot.constants.joint_parameters[j],
                       robot.constants.joint_parameters[kJoints + j]);
    }
    const auto plan = sample_plan(kSeed);
    for (int trial = 0; trial < 200; ++trial) {
      plan->node[1].state = random_state(random);
      plan->node[1].input = random_input(random);
      for (int foot = 0; foot < model::kFeet; ++foot) {  // forces that the ground can give
        double* force = plan->node[1].input.data() + kJoints + 2 * foot;
        const bool stance = plan->node[1].mode[foot];
        force[1] = stance ? 100.0 + std::abs(force[1]) : 0.0;
        force[0] = stance ? std::clamp(force[0], -50.0, 50.0) : 0.0;
      }
      const model::StateVector& state = plan->node[1].state;
      const SensorReading reading = reading_of(state, plan->node[1].time_s);
      const TorqueCommand command = law.follow(reading, state, interpolate(*plan, reading.time_s));
      ASSERT_TRUE(command.finite);
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
