#include "host_tools/robot_on_bus/base_sensor_frames.h"

#include <gtest/gtest.h>

#include "tests/host_tools/robot_on_bus/driven_robot.h"

namespace stilt::robot_on_bus {
namespace {

using hal::protocol::BaseChannel;
using testing_support::DrivenRobot;

constexpr double kDegree_rad = 0.017453292519943295;

TEST(BaseSensorFrames, TheTableReadsBackEveryChannelFromAFrameAnIdentifier) {
  hal::RobotWiring wiring;
  wiring.channels[0] = {.id = 0x50, .bits = 32, .scale = 1e-6, .channel = BaseChannel::pitch_rad};
  wiring.channels[1] = {
      .id = 0x50, .byte_offset = 4, .bits = 24, .scale = 1e-5, .channel = BaseChannel::pitch_rate_rad_s};
  wiring.channels[2] = {.id = 0x51,
                        .extended = true,
                        .byte_offset = 6,
                        .order = hal::protocol::ByteOrder::big,
                        .scale = 1e-2,
                        .channel = BaseChannel::acceleration_z_m_s2};
  wiring.channel_count = 3;
  BaseSensorFrames sensor(wiring);
  const std::vector<hal::CanFrame>& frames = sensor.encode({0.25, -1.5, 0, 9.81, 0, 0, 1});
  ASSERT_EQ(frames.size(), 2u);
  hal::protocol::ChannelValues values;
  ASSERT_EQ(decode(std::span(wiring.channels).first(3), frames[0], values), hal::protocol::DecodeStatus::ok);
  EXPECT_NEAR(values[BaseChannel::pitch_rad], 0.25, 1e-6);
  EXPECT_NEAR(values[BaseChannel::pitch_rate_rad_s], -1.5, 1e-5);
  ASSERT_EQ(decode(std::span(wiring.channels).first(3), frames[1], values), hal::protocol::DecodeStatus::ok);
  EXPECT_NEAR(values[BaseChannel::acceleration_z_m_s2], 9.81, 1e-2);
  for (const hal::CanFrame& frame : frames) EXPECT_TRUE(well_formed(frame));
}

TEST(BaseSensorFrames, AChannelBeyondEightBytesMakesAnFdFrame) {
  hal::RobotWiring wiring;
  wiring.channels[0] = {.id = 0x50, .byte_offset = 10, .channel = BaseChannel::pitch_rad};
  wiring.channel_count = 1;
  const std::vector<hal::CanFrame> frames = BaseSensorFrames(wiring).encode({});
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_TRUE(frames[0].fd);
  EXPECT_EQ(frames[0].length, 12);
}

TEST(BaseSensorFrames, TheShippedSensorAt1KilohertzShowsPitchAndSwitchEveryTick) {
  testing_support::RobotRequest request;
  request.settings.emplace_back("base_sensor.rate_hz=1000");
  DrivenRobot driven(request);
  for (int i = 0; i < 5; ++i) {
    driven.tick();
    EXPECT_EQ(driven.base.missed, 0u);
    EXPECT_NEAR(driven.base.pitch_rad, driven.robot.plant().state()[model::kFirstAngle], 1e-4 * kDegree_rad);
    EXPECT_EQ(driven.can.read_emergency_stop(driven.now_ns), hal::EmergencyStopState::released);
  }
}

TEST(BaseSensorFrames, AHangingRobotAtRestFeelsItsWeight) {
  testing_support::RobotRequest request;
  request.settings.emplace_back("base_sensor.acceleration_x=id 0x51 byte 0 bits 16 signed little scale 1e-3");
  request.settings.emplace_back("base_sensor.acceleration_z=id 0x51 byte 2 bits 16 signed little scale 1e-3");
  DrivenRobot driven(request);
  for (int i = 0; i < 2000; ++i) driven.tick();
  EXPECT_NEAR(driven.base.acceleration_z_m_s2, 9.81, 0.05);
  EXPECT_NEAR(driven.base.acceleration_x_m_s2, 0.0, 0.05);
}

}  // namespace
}  // namespace stilt::robot_on_bus
