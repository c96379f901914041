#include "host_tools/simulation/robot_on_bus/torso_sensor_frames.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/host_tools/simulation/robot_on_bus/driven_robot.h"

namespace stilt::robot_on_bus {
namespace {

using hal::BaseChannel;
using testing_support::DrivenRobot;

constexpr double kDegree_rad = 0.017453292519943295;

TEST(TorsoSensorFrames, TheTableReadsBackEveryChannelFromAFrameAnIdentifier) {
  hal::RobotWiring wiring;
  wiring.channels[0] = {.id = 0x50, .bits = 32, .scale = 1e-6, .channel = BaseChannel::pitch_rad};
  wiring.channels[1] = {
      .id = 0x50, .byte_offset = 4, .bits = 24, .scale = 1e-5, .channel = BaseChannel::pitch_rate_rad_s};
  wiring.channels[2] = {.id = 0x51,
                        .extended = true,
                        .byte_offset = 6,
                        .order = hal::ByteOrder::big,
                        .scale = 1e-2,
                        .channel = BaseChannel::acceleration_z_m_s2};
  wiring.channel_count = 3;
  TorsoSensorFrames sensor(wiring);
  const std::vector<hal::CanFrame>& frames = sensor.encode({0.25, -1.5, 0, 9.81, 0, 0, 1});
  ASSERT_EQ(frames.size(), 2u);
  hal::ChannelValues values;
  ASSERT_EQ(decode(std::span(wiring.channels).first(3), frames[0], values), hal::DecodeStatus::ok);
  EXPECT_NEAR(values[BaseChannel::pitch_rad], 0.25, 1e-6);
  EXPECT_NEAR(values[BaseChannel::pitch_rate_rad_s], -1.5, 1e-5);
  ASSERT_EQ(decode(std::span(wiring.channels).first(3), frames[1], values), hal::DecodeStatus::ok);
  EXPECT_NEAR(values[BaseChannel::acceleration_z_m_s2], 9.81, 1e-2);
  for (const hal::CanFrame& frame : frames) EXPECT_TRUE(well_formed(frame));
}

TEST(TorsoSensorFrames, AChannelBeyondEightBytesMakesAnFdFrame) {
  hal::RobotWiring wiring;
  wiring.channels[0] = {.id = 0x50, .byte_offset = 10, .channel = BaseChannel::pitch_rad};
  wiring.channel_count = 1;
  const std::vector<hal::CanFrame> frames = TorsoSensorFrames(wiring).encode({});
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_TRUE(frames[0].fd);
  EXPECT_EQ(frames[0].length, 12);
}

TEST(TorsoSensorFrames, ANumberIsTwoIdentifiersWhenOneIsExtended) {
  hal::RobotWiring wiring;
  wiring.channels[0] = {.id = 0x50, .channel = BaseChannel::pitch_rad};
  wiring.channels[1] = {.id = 0x50, .extended = true, .channel = BaseChannel::pitch_rate_rad_s};
  wiring.channel_count = 2;
  const std::vector<hal::CanFrame> frames = TorsoSensorFrames(wiring).encode({});
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_FALSE(frames[0].extended);
  EXPECT_TRUE(frames[1].extended);
}

TEST(TorsoSensorFrames, TheShippedSensorAt1KilohertzShowsPitchAndSwitchEveryTick) {
  testing_support::RobotRequest request;
  request.settings.emplace_back("torso_sensor.rate_hz=1000");
  DrivenRobot driven(request);
  for (int i = 0; i < 5; ++i) {
    driven.tick();
    EXPECT_EQ(driven.base.missed_replies, 0u);
    EXPECT_NEAR(driven.base.pitch_rad, driven.robot.plant().state()[model::kFirstAngle], 1e-4 * kDegree_rad);
    EXPECT_EQ(driven.can.read_emergency_stop(driven.now_ns), hal::EmergencyStopState::released);
  }
}

TEST(TorsoSensorFrames, AHangingRobotAtRestFeelsItsWeight) {
  testing_support::RobotRequest request;
  request.settings.emplace_back(
      "torso_sensor.acceleration_x=id 0x51 byte 0 bits 16 signed little scale 1e-3");
  request.settings.emplace_back(
      "torso_sensor.acceleration_z=id 0x51 byte 2 bits 16 signed little scale 1e-3");
  DrivenRobot driven(request);
  for (int i = 0; i < 2000; ++i) driven.tick();
  EXPECT_NEAR(driven.base.acceleration_z_m_s2, 9.81, 0.05);
  EXPECT_NEAR(driven.base.acceleration_x_m_s2, 0.0, 0.05);
}

/// Leaning forward, +x of the base points downward as well, against which a body at rest is pushed.
TEST(TorsoSensorFrames, ARobotThatHangsAskewFeelsItsWeightInTheFrameOfItsBase) {
  testing_support::RobotRequest request;
  request.settings.emplace_back("torso_sensor.rate_hz=1000");
  request.settings.emplace_back(
      "torso_sensor.acceleration_x=id 0x51 byte 0 bits 16 signed little scale 1e-3");
  request.settings.emplace_back(
      "torso_sensor.acceleration_z=id 0x51 byte 2 bits 16 signed little scale 1e-3");
  RobotSetup setup = testing_support::setup_of(request);
  setup.standing[model::kFirstAngle] = 0.3;
  RobotOnBus robot(setup);
  hal::ChannelValues values;
  std::int64_t now_ns = 1'000'000'000;
  for (int i = 0; i < 3000; ++i) {
    robot.tick(now_ns += testing_support::kTick_ns);
    for (const hal::CanFrame& frame : robot.take_outgoing(now_ns, setup.wiring.channel_bus)) {
      if (frame.id != 0x51) continue;
      static_cast<void>(
          decode(std::span(setup.wiring.channels).first(setup.wiring.channel_count), frame, values));
    }
  }
  const double pitch_rad = robot.plant().state()[model::kFirstAngle];
  ASSERT_GT(pitch_rad, 0.2);
  EXPECT_NEAR(values[BaseChannel::acceleration_x_m_s2], -9.81 * std::sin(pitch_rad), 0.05);
  EXPECT_NEAR(values[BaseChannel::acceleration_z_m_s2], 9.81 * std::cos(pitch_rad), 0.05);
}

}  // namespace
}  // namespace stilt::robot_on_bus
