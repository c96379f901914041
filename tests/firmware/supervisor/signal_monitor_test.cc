// What shows only over several ticks: jumps and contradictions of sensors, torque that does not come, joints
// far from the plan.
#include "firmware/supervisor/signal_monitor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/firmware/supervisor/observations.h"

namespace stilt::supervisor {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kTick_s = 1e-9 * testing::kTick_ns;

/// A joint that swings, q = 0.5 sin(8 t) unless a test changes that, and a torso that sways, 0.1 sin(5 t), as
/// sensors report them.
class SignalMonitorTest : public ::testing::Test {
 protected:
  SignalMonitorTest() { planned_rad_.fill(kNan); }

  const Signals& tick() {
    time_ns_ += testing::kTick_ns;
    const double time_s = 1e-9 * static_cast<double>(time_ns_);
    for (hal::JointReading& joint : joints_) {
      joint.time_ns = time_ns_;
      joint.position_rad = offset_rad_ + swing_rad_ * std::sin(8 * time_s);
      joint.velocity_rad_s = 8 * swing_rad_ * std::cos(8 * time_s);
      joint.torque_Nm = reported_Nm_;
    }
    base_.time_ns = time_ns_;
    base_.pitch_rad = base_offset_rad_ + 0.1 * std::sin(5 * time_s);
    base_.pitch_rate_rad_s = rate_share_ * 0.5 * std::cos(5 * time_s) + rate_bias_rad_s_;
    return monitor_.update({time_ns_, joints_, base_, asked_Nm_, planned_rad_});
  }
  const Signals& run(double duration_s) {
    const Signals* newest = &tick();
    for (double time_s = kTick_s; time_s < duration_s; time_s += kTick_s) {
      newest = &tick();
      largest_torso_rad_ = std::max(largest_torso_rad_, std::abs(newest->torso_mismatch_rad));
    }
    return *newest;
  }

  SignalMonitor monitor_;
  hal::JointReadings joints_;
  hal::BaseReading base_;
  hal::JointValues asked_Nm_{};
  hal::JointValues planned_rad_{};
  std::int64_t time_ns_ = 1'000'000'000;
  double swing_rad_ = 0.5, offset_rad_ = 0, reported_Nm_ = 0, base_offset_rad_ = 0, rate_share_ = 1,
         rate_bias_rad_s_ = 0;
  double largest_torso_rad_ = 0;
};

TEST_F(SignalMonitorTest, AJointThatMovesAsItsRateSaysDoesNotJump) {
  for (int i = 0; i < 1000; ++i) EXPECT_LT(tick().encoder_jump_rad[1], 1e-4);
}

TEST_F(SignalMonitorTest, AJumpShowsWithItsSizeInOneTick) {
  run(0.1);
  offset_rad_ = -0.3;
  EXPECT_NEAR(tick().encoder_jump_rad[2], 0.3, 1e-4);
  EXPECT_LT(tick().encoder_jump_rad[2], 1e-4);
}

TEST_F(SignalMonitorTest, MissedRepliesAreNoJump) {
  run(0.1);
  const hal::JointReadings before = joints_;
  for (int i = 0; i < 9; ++i) {
    time_ns_ += testing::kTick_ns;
    EXPECT_EQ(monitor_.update({time_ns_, before, base_, asked_Nm_, planned_rad_}).encoder_jump_rad[0], 0);
  }
  EXPECT_LT(tick().encoder_jump_rad[0], 0.005) << "9 ms of 4 rad/s are 0.036 rad";
}

TEST_F(SignalMonitorTest, ATorsoThatSwaysAsItsRateSaysIsPlausible) {
  rate_bias_rad_s_ = 0.05;
  run(5.0);
  EXPECT_NEAR(largest_torso_rad_, 0.2 * 0.05, 0.001) << "a bias of the rate counts for 0.2 s";
}

TEST_F(SignalMonitorTest, ARateOfTheWrongSignIsNot) {
  rate_share_ = -1;
  run(5.0);
  const double swing_rad = 2 * 0.1 * 1.0 / std::hypot(1.0, 1.0);  // high pass of 5 rad/s at 5 rad/s
  EXPECT_NEAR(largest_torso_rad_, swing_rad, 0.1 * swing_rad);
}

TEST_F(SignalMonitorTest, APitchThatJumpsIsNot) {
  run(0.5);
  base_offset_rad_ = 0.25;
  EXPECT_NEAR(tick().torso_mismatch_rad, 0.25, 0.01);
  EXPECT_LT(std::abs(run(1.5).torso_mismatch_rad), 0.01) << "and fades";
}

TEST_F(SignalMonitorTest, ATorsoSensorWithoutRateIsNotJudged) {
  rate_bias_rad_s_ = kNan;
  base_offset_rad_ = 1;
  EXPECT_EQ(run(0.1).torso_mismatch_rad, 0);
}

TEST_F(SignalMonitorTest, TorqueThatDoesNotComeShowsWithinTheTimeOfTheMean) {
  asked_Nm_[3] = 40;
  reported_Nm_ = 40;
  asked_Nm_[0] = asked_Nm_[1] = asked_Nm_[2] = 40;
  EXPECT_NEAR(run(1.0).torque_mismatch_Nm[3], 0, 1e-9);
  reported_Nm_ = 0;
  EXPECT_NEAR(run(0.2).torque_mismatch_Nm[3], -40 * (1 - std::exp(-1)), 0.5);
  EXPECT_NEAR(run(2.0).torque_mismatch_Nm[3], -40, 0.1);
  asked_Nm_[3] = -20;
  EXPECT_NEAR(run(2.0).asked_torque_Nm[3], 20, 0.1);
}

TEST_F(SignalMonitorTest, ADriverThatReportsNoTorqueIsNotJudged) {
  asked_Nm_[1] = 60;
  reported_Nm_ = kNan;
  EXPECT_EQ(run(1.0).torque_mismatch_Nm[1], 0);
}

TEST_F(SignalMonitorTest, AJointOffItsPlanShowsWithinTheTimeOfTheMeanAndOneWithoutPlanDoesNot) {
  swing_rad_ = 0;
  planned_rad_[2] = 0;
  EXPECT_EQ(run(0.5).following_error_rad[2], 0);
  planned_rad_[2] = -1;
  EXPECT_NEAR(run(0.05).following_error_rad[2], 1 - std::exp(-1), 0.02);
  const Signals& after = run(0.5);
  EXPECT_NEAR(after.following_error_rad[2], 1, 0.01);
  EXPECT_EQ(after.following_error_rad[1], 0);
}

TEST(AskedTorque, IsTheLawOfTheCommandWithinItsLimit) {
  hal::JointReadings measured = testing::healthy().joints;  // -0.2 or 0.4 rad, 0.1 rad/s
  hal::JointCommands commands{};
  commands.fill({.position_rad = 0.3,
                 .velocity_rad_s = 1,
                 .torque_Nm = 5,
                 .kp_Nm_rad = 20,
                 .kd_Nms_rad = 2,
                 .torque_limit_Nm = 80});
  commands[2].torque_Nm = 300;
  measured[3].position_rad = kNan;
  const hal::JointValues asked_Nm = asked_torque_Nm(commands, measured);
  EXPECT_NEAR(asked_Nm[0], 5 + 20 * 0.5 + 2 * 0.9, 1e-12);
  EXPECT_NEAR(asked_Nm[1], 5 - 20 * 0.1 + 2 * 0.9, 1e-12);
  EXPECT_EQ(asked_Nm[2], 80);
  EXPECT_EQ(asked_Nm[3], 5) << "feed-forward is all that is known";
}

}  // namespace
}  // namespace stilt::supervisor
