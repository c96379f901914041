// The torso sensor of a robot on CAN: channels, age, repetition.
#include <gtest/gtest.h>

#include "hal/robot/can_robot.h"
#include "tests/hal/robot/emulated_robot.h"

namespace stilt::hal {
namespace {

using stilt::hal::testing::Kind;
using stilt::hal::testing::kTick_ns;
using stilt::hal::testing::Robot;

TEST(CanRobot, TheTorsoSensorAndTheEmergencyStopComeFromTheTable) {
  Robot robot(Kind::mit);
  BaseReading base;
  EXPECT_EQ(robot.robot_->read_base(base), TorsoSensorStatus::stale);
  EXPECT_EQ(robot.robot_->read_emergency_stop(robot.clock_.now_ns()), EmergencyStopState::unknown);
  CanFrame frame = classic_frame(0x50, 4);
  frame.data = {0x64, 0x00, 0x01, 0x00};
  robot.buses_[0].script(frame, robot.clock_.now_ns());
  static_cast<void>(robot.read());
  EXPECT_EQ(robot.robot_->read_base(base), TorsoSensorStatus::ok);
  EXPECT_DOUBLE_EQ(base.pitch_rad, 0.1);
  EXPECT_EQ(robot.robot_->read_emergency_stop(robot.clock_.now_ns()), EmergencyStopState::released);
  robot.clock_.advance(200 * kTick_ns);
  EXPECT_EQ(robot.robot_->read_emergency_stop(robot.clock_.now_ns()), EmergencyStopState::unknown)
      << "silent too long";
  frame.data[2] = 0;
  robot.buses_[0].script(frame, robot.clock_.now_ns());
  static_cast<void>(robot.read());
  EXPECT_EQ(robot.robot_->read_emergency_stop(robot.clock_.now_ns()), EmergencyStopState::pressed);
}

TEST(CanRobot, ATorsoSensorSlowerThanTheReadsIsMissedOnlyWhenItsFrameIsDue) {
  Robot robot(Kind::mit);
  robot.wiring_.channel_period_ticks = 3;
  const std::array<FrameBus*, 2> buses{&robot.buses_[0], &robot.buses_[1]};
  CanRobot slow(robot.wiring_, buses);
  robot.buses_[0].script(classic_frame(0x50, 4), robot.clock_.now_ns());
  for (const std::uint32_t missed : {0u, 0u, 0u, 1u, 2u}) {
    static_cast<void>(slow.read(robot.clock_.now_ns(), robot.readings_));
    BaseReading base;
    static_cast<void>(slow.read_base(base));
    EXPECT_EQ(base.missed_replies, missed);
    robot.clock_.advance(kTick_ns);
  }
}

TEST(CanRobot, ARateThatStopsIsMissedThoughThePitchGoesOn) {
  Robot robot(Kind::mit);
  robot.wiring_.channels[2] = {
      .id = 0x51, .byte_offset = 0, .scale = 1e-3, .channel = BaseChannel::pitch_rate_rad_s};
  robot.wiring_.channel_count = 3;
  const std::array<FrameBus*, 2> buses{&robot.buses_[0], &robot.buses_[1]};
  CanRobot with_rate(robot.wiring_, buses);
  BaseReading base;
  const auto missed_after = [&](bool pitch, bool rate) {
    if (pitch) robot.buses_[0].script(classic_frame(0x50, 4), robot.clock_.now_ns());
    if (rate) robot.buses_[0].script(classic_frame(0x51, 4), robot.clock_.now_ns());
    static_cast<void>(with_rate.read(robot.clock_.now_ns(), robot.readings_));
    static_cast<void>(with_rate.read_base(base));
    robot.clock_.advance(kTick_ns);
    return base.missed_replies;
  };
  EXPECT_EQ(missed_after(true, true), 0u);
  EXPECT_EQ(missed_after(true, false), 1u);
  EXPECT_EQ(missed_after(true, false), 2u);
  EXPECT_EQ(missed_after(false, true), 1u);
  EXPECT_EQ(missed_after(true, true), 0u);
}

TEST(CanRobot, ARepetitionOfASlowTorsoSensorCountsTheReadsItLasts) {
  Robot robot(Kind::mit);
  robot.wiring_.channel_period_ticks = 3;
  const std::array<FrameBus*, 2> buses{&robot.buses_[0], &robot.buses_[1]};
  CanRobot slow(robot.wiring_, buses);
  BaseReading base;
  for (int tick = 0; tick < 9; ++tick) {
    if (tick % 3 == 0) robot.buses_[0].script(classic_frame(0x50, 4), robot.clock_.now_ns());
    static_cast<void>(slow.read(robot.clock_.now_ns(), robot.readings_));
    static_cast<void>(slow.read_base(base));
    robot.clock_.advance(kTick_ns);
  }
  EXPECT_EQ(base.unchanged_replies, 6u) << "the second and the third frame";
}

TEST(CanRobot, ATorsoSensorWhosePitchStaysEqualWhileItsRateChangesIsNotFrozen) {
  Robot robot(Kind::mit);
  robot.wiring_.channels[2] = {
      .id = 0x50, .byte_offset = 4, .scale = 1e-3, .channel = BaseChannel::pitch_rate_rad_s};
  robot.wiring_.channel_count = 3;
  const std::array<FrameBus*, 2> buses{&robot.buses_[0], &robot.buses_[1]};
  CanRobot with_rate(robot.wiring_, buses);
  BaseReading base;
  const auto frozen_after = [&](std::uint8_t rate) {
    CanFrame frame = classic_frame(0x50, 8);
    frame.data[4] = rate;
    robot.buses_[0].script(frame, robot.clock_.now_ns());
    static_cast<void>(with_rate.read(robot.clock_.now_ns(), robot.readings_));
    static_cast<void>(with_rate.read_base(base));
    robot.clock_.advance(kTick_ns);
    return base.unchanged_replies;
  };
  EXPECT_EQ(frozen_after(1), 0u);
  EXPECT_EQ(frozen_after(2), 0u);
  EXPECT_EQ(frozen_after(2), 1u);
  EXPECT_EQ(frozen_after(2), 2u);
  EXPECT_EQ(frozen_after(1), 0u);
}

}  // namespace
}  // namespace stilt::hal
