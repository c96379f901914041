#include "mpc_core/control/gait_tracker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include "firmware/configuration/gaits/shipped_gaits.h"
#include "tests/robots.h"

namespace stilt::control {
namespace {

using model::kFirstJoint;
using model::kJoints;

class Tracker : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(gait_files::load_shipped_library("amber3m", *library_));
    tracker_->configure(testing_support::amber3m(), parameters_, {}, *library_);
  }

  /// What the sensors give at s of a step that began at time 0 with `stance` on the ground.
  [[nodiscard]] SensorReading reading(double speed_m_s, double s, int stance) const {
    const gait::GaitPoint point = library_->motion_at(speed_m_s, s);
    SensorReading result;
    result.time_s = s * library_->step_time_s();
    const int first = stance == model::kLeft ? 0 : 2;
    for (int i = 0; i < kJoints; ++i) {
      const int joint = (first + i) % kJoints;
      result.joint_position_rad[joint] = point.position[kFirstJoint + i];
      result.joint_velocity_rad_s[joint] = point.velocity[kFirstJoint + i];
    }
    result.base_pitch_rad = point.position[2];
    result.base_pitch_rate_rad_s = point.velocity[2];
    return result;
  }

  GaitTrackerParameters parameters_;
  std::unique_ptr<gait::GaitLibrary> library_ = std::make_unique<gait::GaitLibrary>();
  std::unique_ptr<GaitTracker> tracker_ = std::make_unique<GaitTracker>();
};

/// Of most of these gaits the phase is the base over the stance foot.
TEST_F(Tracker, OnTheGaitCommandsItsTorqueAndTheMotionOfItsJoints) {
  for (const double speed_m_s : {-0.3, 0.0, 0.5, 1.0}) {
    for (const int stance : {model::kLeft, model::kRight}) {
      tracker_->start(0.0, stance, speed_m_s);
      for (const double s : {0.1, 0.35, 0.6, 0.9}) {
        const gait::GaitPoint wanted = library_->motion_at(speed_m_s, s);
        const auto command = tracker_->tick(reading(speed_m_s, s, stance), speed_m_s);
        ASSERT_TRUE(command.finite);
        const int first = stance == model::kLeft ? 0 : 2;
        for (int i = 0; i < kJoints; ++i) {
          const int joint = (first + i) % kJoints;
          const auto where = [&] { return std::to_string(speed_m_s) + " m/s, s " + std::to_string(s); };
          EXPECT_NEAR(command.torque_Nm[joint], wanted.torque_Nm[i], 0.3) << where();
          EXPECT_NEAR(command.position_rad[joint], wanted.position[kFirstJoint + i], 1e-5) << where();
          EXPECT_NEAR(command.velocity_rad_s[joint], wanted.velocity[kFirstJoint + i], 1e-4) << where();
        }
        EXPECT_EQ(tracker_->stance(), stance);
      }
    }
  }
}

TEST_F(Tracker, PullsTheJointsBackInProportion) {
  tracker_->start(0.0, model::kLeft, 0.0);
  SensorReading off = reading(0.0, 0.5, model::kLeft);
  const auto before = tracker_->tick(off, 0.0);
  off.joint_position_rad[2] += 0.01;  // the swing hip: no part in phase or base
  off.joint_velocity_rad_s[3] -= 0.1;
  const auto after = tracker_->tick(off, 0.0);
  EXPECT_NEAR(after.torque_Nm[2] - before.torque_Nm[2], -0.01 * parameters_.joint_kp_Nm_rad, 1e-9);
  EXPECT_NEAR(after.torque_Nm[3] - before.torque_Nm[3], 0.1 * parameters_.joint_kd_Nms_rad, 1e-9);
  EXPECT_EQ(after.torque_Nm[0], before.torque_Nm[0]);
}

/// The lead from other motion, by its definition. At the take-over the command is what is measured, and the
/// motion of the command is continuous until it is the gait's.
TEST_F(Tracker, LeadsTheJointsFromWhatTheyDidToTheGait) {
  constexpr double kTick_s = 1e-3;
  const auto off = [&](double s) {
    SensorReading result = reading(0.0, s, model::kLeft);  // in place, where the phase is the time
    for (int j = 0; j < kJoints; ++j) {
      result.joint_position_rad[j] += 0.1 - 0.05 * j;
      result.joint_velocity_rad_s[j] += 0.3 * j;
    }
    return result;
  };
  parameters_.take_over_s = 0.2;
  parameters_.settle_s = 0.5;  // no foot placement
  tracker_->configure(testing_support::amber3m(), parameters_, {}, *library_);
  const double step_time_s = library_->step_time_s();
  tracker_->start(0.0, model::kLeft, 0.0);
  tracker_->take_over();
  auto before = tracker_->tick(off(0.1), 0.0);
  for (int j = 0; j < kJoints; ++j) {
    EXPECT_NEAR(before.position_rad[j], off(0.1).joint_position_rad[j], 1e-12);
    EXPECT_NEAR(before.velocity_rad_s[j], off(0.1).joint_velocity_rad_s[j], 1e-12);
  }
  for (double t_s = kTick_s; t_s < 0.21; t_s += kTick_s) {
    const auto now = tracker_->tick(off(0.1 + t_s / step_time_s), 0.0);
    for (int j = 0; j < kJoints; ++j) {
      const double moved_rad = now.position_rad[j] - before.position_rad[j];
      const double mean_rad_s = 0.5 * (now.velocity_rad_s[j] + before.velocity_rad_s[j]);
      EXPECT_NEAR(moved_rad, kTick_s * mean_rad_s, 1e-4) << "joint " << j << " at " << t_s << " s";
    }
    before = now;
  }
  GaitTracker gait;
  gait.configure(testing_support::amber3m(), parameters_, {}, *library_);
  gait.start(0.0, model::kLeft, 0.0);
  const auto led = tracker_->tick(off(0.85), 0.0);
  const auto alone = gait.tick(off(0.85), 0.0);
  EXPECT_EQ(led.position_rad, alone.position_rad);
  EXPECT_EQ(led.velocity_rad_s, alone.velocity_rad_s);
  EXPECT_EQ(led.torque_Nm, alone.torque_Nm);
}

TEST_F(Tracker, PlacesTheFootOnceInAStepAndAnewInEveryStep) {
  const auto torque_of_a_lean_Nm = [&] {
    SensorReading leaning = reading(0.0, 0.4, model::kLeft);
    leaning.base_pitch_rad += 0.05;
    return tracker_->tick(leaning, 0.0).torque_Nm;
  };
  tracker_->start(0.0, model::kLeft, 0.0);
  const model::JointVector placed_Nm = torque_of_a_lean_Nm();
  tracker_->start(0.0, model::kLeft, 0.0);
  (void)tracker_->tick(reading(0.0, 0.1, model::kLeft), 0.0);  // on the gait: nothing to correct
  EXPECT_GT((placed_Nm - torque_of_a_lean_Nm()).cwiseAbs().maxCoeff(), 0.5) << "once in a step";
  tracker_->start(0.0, model::kLeft, 0.0);
  EXPECT_EQ(torque_of_a_lean_Nm(), placed_Nm);
}

TEST_F(Tracker, PlacesTheFootAgainstALeanByTheGaitsFeedback) {
  constexpr double kLean_rad = 0.02;
  SensorReading leaning = reading(0.0, 0.4, model::kLeft);
  leaning.base_pitch_rad += kLean_rad;
  tracker_->start(0.0, model::kLeft, 0.0);
  const double placed_rad = tracker_->tick(leaning, 0.0).position_rad[2];
  tracker_->start(0.0, model::kLeft, 0.0);
  (void)tracker_->tick(reading(0.0, 0.1, model::kLeft), 0.0);  // on the gait: nothing to correct
  const double unplaced_rad = tracker_->tick(leaning, 0.0).position_rad[2];
  gait::HzdGait gait;
  library_->blend(0.0, gait);
  const double whole_rad = -gait.feedback.placement[0] * kLean_rad;  // of which s has a share
  ASSERT_GT(std::abs(whole_rad), 1e-3);
  EXPECT_GT((placed_rad - unplaced_rad) / whole_rad, 0.1);
  EXPECT_LT((placed_rad - unplaced_rad) / whole_rad, 0.6);
}

TEST_F(Tracker, SwapsTheLegsWhenTheSwingFootComesDownAndNotBefore) {
  tracker_->start(0.0, model::kLeft, 0.5);
  (void)tracker_->tick(reading(0.5, 0.99, model::kLeft), 0.5);
  EXPECT_EQ(tracker_->stance(), model::kLeft);
  SensorReading landed = reading(0.5, 1.0, model::kLeft);
  landed.joint_position_rad[3] -= 0.01;  // a straighter knee reaches the ground
  const auto command = tracker_->tick(landed, 0.5);
  EXPECT_EQ(tracker_->stance(), model::kRight);
  const gait::GaitPoint begun = library_->motion_at(0.5, 0.0);
  for (int i = 0; i < kJoints; ++i) {
    EXPECT_NEAR(command.position_rad[(2 + i) % kJoints], begun.position[kFirstJoint + i], 1e-5);
  }
  tracker_->start(0.0, model::kLeft, 0.5);
  SensorReading scuffing = reading(0.5, 0.2, model::kLeft);
  scuffing.joint_position_rad[3] -= 0.3;
  (void)tracker_->tick(scuffing, 0.5);
  EXPECT_EQ(tracker_->stance(), model::kLeft) << "the foot has only just left the ground";
}

TEST_F(Tracker, LimitsTorqueAndDampsWithoutFiniteSensors) {
  tracker_->start(0.0, model::kLeft, 0.5);
  SensorReading far = reading(0.5, 0.5, model::kLeft);
  far.joint_position_rad[2] += 1.0;
  EXPECT_EQ(tracker_->tick(far, 0.5).torque_Nm[2], -testing_support::amber3m().constants.torque_limit_Nm[2]);
  SensorReading broken = reading(0.5, 0.5, model::kLeft);
  broken.base_pitch_rad = std::numeric_limits<double>::quiet_NaN();
  broken.joint_velocity_rad_s = {0.5, -1.0, std::numeric_limits<double>::infinity(), 0.0};
  const auto command = tracker_->tick(broken, 0.5);
  EXPECT_FALSE(command.finite);
  EXPECT_EQ(command.torque_Nm, model::JointVector(-10.0, 20.0, 0.0, 0.0));
  EXPECT_TRUE(std::isnan(command.position_rad[0]));
}

}  // namespace
}  // namespace stilt::control
