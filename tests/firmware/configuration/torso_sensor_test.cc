#include <gtest/gtest.h>

#include <numbers>
#include <span>
#include <string>

#include "firmware/configuration/configuration.h"
#include "firmware/configuration/hardware.h"
#include "hal/robot/robot_wiring.h"
#include "tests/hal/hex.h"

// [torso_sensor]: what measures the pitch, and what its frames carry.
namespace stilt::configuration {
namespace {

/// All diagnostics of a file, "" when it is accepted.
std::string mistakes(const std::string& lines) {
  const Result result = parse("[torso_sensor]\n" + lines, "robot.toml");
  return result ? "" : to_string(result.error());
}

hal::RobotWiring wiring_of(const std::string& lines) {
  const Result result = parse("[torso_sensor]\n" + lines, "robot.toml");
  EXPECT_TRUE(result) << to_string(result.error());
  return robot_wiring(result->hardware);
}

TEST(TorsoSensor, AnEncoderOnCanopenTakesThePlaceOfThePitchChannels) {
  const hal::RobotWiring wiring = wiring_of(
      "device = \"canopen_encoder\"\nbus = 1\nencoder_node = 7\nencoder_steps = 131072\nencoder_turns = "
      "4096\n"
      "encoder_ratio = 3\nencoder_reversed = true\nencoder_offset_rad = 0.1\nencoder_speed_rad_s = 0.002\n");
  ASSERT_TRUE(wiring.pitch_encoder);
  EXPECT_EQ(wiring.pitch_encoder->node, 7);
  EXPECT_EQ(wiring.pitch_encoder->steps_per_turn, 131072u);
  EXPECT_EQ(wiring.pitch_encoder->turns, 4096u);
  EXPECT_EQ(wiring.pitch_encoder->speed_rad_s, 0.002);
  EXPECT_EQ(wiring.pitch_encoder_bus, 1);
  EXPECT_EQ(wiring.pitch_direction, -1);
  EXPECT_EQ(wiring.pitch_ratio, 3);
  EXPECT_EQ(wiring.pitch_offset_rad, 0.1);
  EXPECT_EQ(wiring.channel_count, 1u) << "the emergency stop is left";
  const hal::TorsoSensorTraits traits = hal::torso_sensor_traits(wiring);
  EXPECT_TRUE(traits.has_rate);
  EXPECT_DOUBLE_EQ(traits.pitch_period_rad, 4096 * 2 * std::numbers::pi / 3);
}

TEST(TorsoSensor, WithoutASpeedTheRateIsThatOfThePitch) {
  EXPECT_FALSE(hal::torso_sensor_traits(wiring_of("device = \"canopen_encoder\"\n")).has_rate);
  const hal::TorsoSensorTraits traits =
      hal::torso_sensor_traits(wiring_of("pitch_rate = \"none\"\nrate_window_s = 0.02\n"));
  EXPECT_FALSE(traits.has_rate);
  EXPECT_EQ(traits.rate_window_s, 0.02);
  EXPECT_TRUE(hal::torso_sensor_traits(wiring_of("")).has_rate);
}

TEST(TorsoSensor, ARollRepeatsAfterATurnAndAPitchDoesNot) {
  for (const std::string device : {"xsens_can", "vectornav"}) {
    const auto period_rad = [&](const std::string& axis) {
      const hal::RobotWiring wiring = wiring_of(std::string("rate_hz = 400\ndevice = \"")
                                                    .append(device)
                                                    .append("\"\nimu_axis = \"")
                                                    .append(axis)
                                                    .append("\"\n"));
      EXPECT_TRUE(hal::valid(wiring, 2));
      return hal::torso_sensor_traits(wiring).pitch_period_rad;
    };
    EXPECT_DOUBLE_EQ(period_rad("roll"), 2 * std::numbers::pi) << device;
    EXPECT_EQ(period_rad("pitch"), 0) << device;
  }
  EXPECT_EQ(hal::torso_sensor_traits(wiring_of("")).pitch_period_rad, 0);
}

/// Frames by hand from MT1604P, 6.3.2 and 6.4.2: roll, pitch, yaw in steps of 2^-7 degrees, rates about x, y,
/// z in steps of 2^-9 rad/s. The most significant byte is first. Pitch -45 degrees is 0xe980, 1 rad/s 0x0200.
TEST(TorsoSensor, AnXsensIsReadAsItsManualSays) {
  const auto values = [](const std::string& lines, std::uint32_t id, const char* bytes) {
    const hal::RobotWiring wiring = wiring_of("device = \"xsens_can\"\nrate_hz = 400\n" + lines);
    const hal::CanFrame frame = hal::testing::with_payload(hal::classic_frame(id, 6), bytes);
    hal::ChannelValues found;
    EXPECT_EQ(decode(std::span(wiring.channels).first(wiring.channel_count), frame, found),
              hal::DecodeStatus::ok);
    return found;
  };
  constexpr double kDegree_rad = std::numbers::pi / 180;
  using enum hal::BaseChannel;
  EXPECT_DOUBLE_EQ(values("", 0x022, "2d00e9804000")[pitch_rad], -45 * kDegree_rad);
  EXPECT_DOUBLE_EQ(values("imu_axis = \"roll\"\n", 0x022, "2d00e9804000")[pitch_rad], 90 * kDegree_rad);
  EXPECT_DOUBLE_EQ(values("imu_reversed = true\nimu_offset_rad = 0.02\n", 0x022, "2d00e9804000")[pitch_rad],
                   45 * kDegree_rad + 0.02);
  EXPECT_DOUBLE_EQ(values("", 0x032, "000002000400")[pitch_rate_rad_s], 1.0);
  EXPECT_DOUBLE_EQ(
      values("imu_axis = \"roll\"\nimu_reversed = true\n", 0x032, "fe0002000400")[pitch_rate_rad_s], 1.0);
}

TEST(TorsoSensor, AVectornavIsMountedAsConfigured) {
  const hal::RobotWiring wiring =
      wiring_of("device = \"vectornav\"\nimu_axis = \"roll\"\nimu_reversed = true\nimu_offset_rad = -0.3\n");
  ASSERT_TRUE(wiring.serial_imu);
  EXPECT_TRUE(wiring.serial_imu->by_roll);
  EXPECT_EQ(wiring.serial_imu->direction, -1);
  EXPECT_EQ(wiring.serial_imu->offset_rad, -0.3);
  EXPECT_FALSE(hal::pitch_is_channel(wiring));
  EXPECT_EQ(wiring.channel_count, 1u);
}

TEST(TorsoSensor, WhatFramesCannotCarryIsRefused) {
  EXPECT_EQ(
      mistakes("pitch = \"id 0x150 byte 0 bits 16 signed little scale 2e-5\"\n"),
      "robot.toml:2:9: torso_sensor.pitch carries at most 0.65534 rad either way, and must carry 0.8 rad, "
      "supervisor.base_pitch_limit_rad");
  EXPECT_EQ(
      mistakes("pitch_rate = \"id 0x150 byte 3 bits 8 signed little scale 0.02\"\n"),
      "robot.toml:2:14: torso_sensor.pitch_rate carries at most 2.54 rad/s either way, and must carry 5 "
      "rad/s, which a torso that falls reaches");
  EXPECT_TRUE(mistakes("pitch = \"id 0x150 byte 0 bits 24 unsigned little scale 1e-6\"\n")
                  .starts_with("robot.toml:2:9: torso_sensor.pitch carries at most "))
      << "leaning backward is negative";
  EXPECT_EQ(mistakes("pitch = \"id 0x150 byte 0 bits 24 unsigned little scale 1e-6 offset -8\"\n"), "");
  EXPECT_EQ(mistakes("pitch = \"id 0x160 byte 0 bits 32 float little scale 1\"\n"), "");
  EXPECT_NE(mistakes("device = \"canopen_encoder\"\nencoder_ratio = 4\n")
                .find("torso_sensor.encoder_ratio carries"),
            std::string::npos)
      << "repeats every quarter turn";
  EXPECT_EQ(mistakes("device = \"canopen_encoder\"\nencoder_ratio = 4\nencoder_turns = 4\n"), "");
  EXPECT_NE(mistakes("device = \"canopen_encoder\"\nencoder_speed_rad_s = 1e-4\n")
                .find("torso_sensor.encoder_speed_rad_s carries at most 3.2768 rad/s"),
            std::string::npos);
}

TEST(TorsoSensor, AUnitByItsPitchMustReadBackFromTheFall) {
  const auto fall = [](const std::string& lines, const std::string& limit_rad) {
    return mistakes(lines + "rate_hz = 400\n[supervisor]\nbase_pitch_limit_rad = " + limit_rad + "\n");
  };
  for (const std::string device : {"device = \"xsens_can\"\n", "device = \"vectornav\"\n"}) {
    EXPECT_EQ(fall(device, "1.57"), "");
    EXPECT_NE(fall(device, "1.58")
                  .find("torso_sensor.imu_axis carries at most 1.5707963267948966 rad either "
                        "way, and must carry 1.58 rad, supervisor.base_pitch_limit_rad"),
              std::string::npos)
        << fall(device, "1.58");
    EXPECT_EQ(fall(device + "imu_axis = \"roll\"\n", "3.2"), "") << "it goes on beyond half a turn";
    EXPECT_EQ(fall(device + "imu_offset_rad = -0.7\n", "0.8"), "");
    EXPECT_NE(fall(device + "imu_offset_rad = -0.8\n", "0.8"), "") << "mounted at an angle";
  }
}

TEST(TorsoSensor, AnXsensSendsAtMost400AnglesASecond) {
  EXPECT_EQ(mistakes("device = \"xsens_can\"\nrate_hz = 400\n"), "");
  EXPECT_EQ(
      mistakes("device = \"xsens_can\"\nrate_hz = 401\n"),
      "robot.toml:3:11: torso_sensor.rate_hz = 401, and an Xsens MTi sends at most 400 angles per second");
}

TEST(TorsoSensor, ARateFromPitchesNeedsFineStepsAndEnoughOfThem) {
  const std::string encoder = "device = \"canopen_encoder\"\n";
  EXPECT_NE(mistakes(encoder + "encoder_steps = 8192\n").find("has steps of 0.0766"), std::string::npos);
  EXPECT_EQ(mistakes(encoder + "encoder_steps = 8192\nencoder_speed_rad_s = 0.01\n"), "");
  EXPECT_EQ(mistakes(encoder + "encoder_steps = 8192\nencoder_turns = 4096\nencoder_ratio = 4\n"), "");
  EXPECT_NE(mistakes(encoder + "rate_hz = 100\n").find("holds 1 pitches at torso_sensor.rate_hz = 100"),
            std::string::npos);
  EXPECT_EQ(mistakes(encoder + "rate_hz = 100\nrate_window_s = 0.02\n"), "");
  EXPECT_NE(mistakes(encoder + "rate_hz = 2000\nrate_window_s = 0.05\n").find("takes 2 to 60"),
            std::string::npos);
  EXPECT_NE(mistakes("pitch_rate = \"none\"\npitch = \"id 0x150 byte 0 bits 16 signed little scale 1e-3\"\n")
                .find("nothing measures the pitch rate"),
            std::string::npos);
}

TEST(TorsoSensor, SettingsThatContradictOneAnotherAreRefused) {
  EXPECT_NE(
      mistakes("device = \"vectornav\"\nserial_baud = 128000\n")
          .find("torso_sensor.serial_baud = 128000 is no bit rate of the sensor; right are 9600, 19200"),
      std::string::npos);
  EXPECT_NE(mistakes("device = \"vectornav\"\nserial_baud = 115200\n")
                .find("torso_sensor.serial_baud = 115200 carries at most 345 messages per second, and "
                      "torso_sensor.rate_hz is 500"),
            std::string::npos);
  EXPECT_EQ(mistakes("device = \"vectornav\"\nserial_baud = 115200\nrate_hz = 200\n"), "");
  EXPECT_NE(mistakes("device = \"vectornav\"\nserial_port = \"ttyUSB0\"\n").find("is no absolute path"),
            std::string::npos);
  EXPECT_NE(mistakes("device = \"canopen_encoder\"\nencoder_steps = 1073741824\nencoder_turns = 5\n")
                .find("at most 2^32"),
            std::string::npos);
  const Result both = parse(
      "[hip_driver]\nprotocol = \"moteus\"\nmoteus_kp_Nm_rev = 2000\n[torso_sensor]\ndevice = \"xsens_can\"\n"
      "encoder_joint = 0\n",
      "robot.toml");
  ASSERT_FALSE(both);
  EXPECT_NE(
      to_string(both.error()).find("torso_sensor.encoder_joint = 0, and torso_sensor.device is another"),
      std::string::npos);
}

TEST(TorsoSensor, NodesWhoseIdentifiersCollideWithTheSensorsAreRefused) {
  EXPECT_NE(mistakes("device = \"xsens_can\"\nrate_hz = 400\n[hip_L]\nreply_id = 0x22\n")
                .find("torso_sensor.device and hip_L are on bus 0 and their frames collide"),
            std::string::npos);
  EXPECT_NE(mistakes("device = \"canopen_encoder\"\n[hip_L]\nreply_id = 0x1a0\n")
                .find("torso_sensor.encoder_node and hip_L"),
            std::string::npos)
      << "its positions have 0x180 + 32";
  EXPECT_NE(
      mistakes(
          "device = \"canopen_encoder\"\nemergency_stop_released = \"id 0x1a0 byte 0 bits 1 unsigned\"\n")
          .find("torso_sensor.encoder_node and torso_sensor.emergency_stop_released"),
      std::string::npos);
}

TEST(TorsoSensor, AnEmergencyStopThatCanNeverReadAsPressedIsRefused) {
  const auto of = [](const std::string& field) {
    return mistakes("emergency_stop_released = \"id 0x150 byte 5 bits " + field + "\"\n");
  };
  for (const char* wrong : {"1 unsigned little scale 1 offset 1", "2 unsigned little scale 0.3 offset -0.5",
                            "1 signed little scale 1 offset -1"}) {
    EXPECT_NE(of(wrong).find("is 0 for no raw value"), std::string::npos) << wrong;
  }
  for (const char* right : {"1 unsigned little scale 1", "1 unsigned little scale -1 offset 1",
                            "8 unsigned little scale 1 offset -255", "1 signed little scale 1 offset 1"}) {
    EXPECT_EQ(of(right), "") << right;
  }
  for (const char* invalid :
       {"1 unsigned little scale 1 invalid 0", "1 unsigned little scale -1 offset 1 invalid 1",
        "8 signed little scale 1 offset 1 invalid 0xff"}) {
    EXPECT_NE(of(invalid).find("has the raw value of a pressed emergency stop as invalid"), std::string::npos)
        << invalid;
  }
  EXPECT_EQ(of("2 unsigned little scale 1 invalid 3"), "");
  EXPECT_NE(mistakes("emergency_stop_released = \"id 0x151 byte 0 bits 32 float offset 0.1\"\n")
                .find("is 0 for no raw value"),
            std::string::npos)
      << "the nearest float is not the offset";
}

// As shipped the pitch has bits 0 to 23 of 0x150, its rate bits 24 to 39, the stop bit 40.
TEST(TorsoSensor, ChannelsThatShareBitsOfAFrameAreRefused) {
  const auto stop = [](const std::string& field) {
    return mistakes("emergency_stop_released = \"id " + field + " unsigned scale 1\"\n");
  };
  EXPECT_EQ(stop("0x150 byte 0 bits 16 little"),
            "robot.toml:2:27: torso_sensor.emergency_stop_released and torso_sensor.pitch share bits of a "
            "frame; give each the bits that the sensor sends for it");
  for (const char* shared :
       {"0x150 byte 2 bit 7 bits 1 little", "0x150 byte 3 bits 1 little", "0x150 byte 4 bit 7 bits 2 little",
        "0x150 byte 1 bit 7 bits 9 big", "0x150 byte 4 bits 16 big"}) {
    EXPECT_NE(stop(shared).find("share bits"), std::string::npos) << shared;
  }
  for (const char* own : {"0x150 byte 5 bits 1 little", "0x150 byte 5 bits 16 big",
                          "0x151 byte 0 bits 1 little", "0x150 extended byte 0 bits 1 little"}) {
    EXPECT_EQ(stop(own), "") << own;
  }
  EXPECT_NE(
      mistakes("pitch_rate = \"id 0x150 byte 2 bits 16 signed little scale 1e-3\"\n").find("share bits"),
      std::string::npos);
}

// Longer than the controller extrapolates a pitch, it would stand still before the next one.
TEST(TorsoSensor, APitchThatComesTooRarelyIsRefused) {
  EXPECT_EQ(mistakes("rate_hz = 100\n"), "");
  EXPECT_EQ(
      mistakes("rate_hz = 99\nemergency_stop_timeout_s = 0.2\n"),
      "robot.toml:2:11: torso_sensor.rate_hz = 99 must be at least 100: the pitch is extrapolated until "
      "the next one, for 10 ms at most");
  EXPECT_NE(mistakes("device = \"canopen_encoder\"\nrate_hz = 99\nrate_window_s = 0.03\n"), "");
  const Result other = parse(
      "[hip_driver]\nprotocol = \"moteus\"\nmoteus_kp_Nm_rev = 2000\n[torso_sensor]\nencoder_joint = 0\n"
      "rate_hz = 50\nemergency_stop_timeout_s = 0.2\n",
      "robot.toml");
  EXPECT_TRUE(other) << "the pitch comes with the replies of hip_L";
}

}  // namespace
}  // namespace stilt::configuration
