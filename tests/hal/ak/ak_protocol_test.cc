#include "hal/ak/ak_protocol.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/hal/hex.h"
#include "tests/hal/random_values.h"

namespace stilt::hal::ak {
namespace {

using stilt::hal::testing::hex;
using stilt::hal::testing::RandomValues;
using stilt::hal::testing::with_payload;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

CanFrame extended(std::uint32_t id, const char* digits) {
  CanFrame frame;
  frame.id = id;
  frame.extended = true;
  return with_payload(frame, digits);
}

// The example of a velocity in section 4.4.1 of manual 3.2.0, as quoted in test_protocol.cpp of ak_v3_driver:
// "kd 2, 6 rad/s". Its velocity has the code of a range of 50 rad/s, which is no motor's. All other fields
// are as section 4.2 has them: 0 is 0x7fff and 0x7ff, so that the scale is 2^n - 1.
TEST(Ak, ThePublishedVelocityCommandIsReproduced) {
  CanFrame frame;
  ASSERT_EQ(encode_command({.velocity_rad_s = 50}, {.velocity_rad_s = 6, .kd_Nms_rad = 2}, frame),
            EncodeStatus::ok);
  EXPECT_EQ(hex(frame), "0006667fff8f57ff");
  EXPECT_EQ(frame.id, 0x868u);
  EXPECT_TRUE(frame.extended);
}

// The example of a position there is "kp 2, kd 2, 6 rad" with 0xbd70: of a range of 12.5 rad, not 12.56.
TEST(Ak, ThePublishedPositionCommandReadsSixRadiansWithinHalfAPercent) {
  AkCodes codes;
  ASSERT_EQ(decode_codes(0x68, extended(0x868, "010666bd707ff7ff"), codes), DecodeStatus::ok);
  const AkCommand command = command_of({}, codes, false);
  EXPECT_NEAR(command.position_rad, 6, 0.03);
  EXPECT_NEAR(command.kp_Nm_rad, 2, 500.0 / 4095);
  EXPECT_NEAR(command.kd_Nms_rad, 2, 5.0 / 4095);
}

// test_protocol.cpp of ak_v3_driver, DecodeStatusFrame and DecodeExtendedPositionFrame.
TEST(Ak, PublishedReportsAreRead) {
  AkStatus status;
  ASSERT_EQ(decode_status({}, extended(0x2968, "03e800c801f41900"), status), DecodeStatus::ok);
  EXPECT_NEAR(status.position_rad, 100 * kDegree, 1e-12);
  EXPECT_NEAR(status.velocity_rad_s, 2000.0 / 21 / 9 * 2 * std::numbers::pi / 60, 1e-12);
  EXPECT_NEAR(status.current_A, 5, 1e-12);
  EXPECT_EQ(status.driver_temperature_C, 25);
  EXPECT_EQ(status.fault, DriverFault::none);
  double position_rad = 0;
  ASSERT_EQ(decode_position({}, extended(0x2a68, "000f424000000000"), position_rad), DecodeStatus::ok);
  EXPECT_NEAR(position_rad, 10'000 * kDegree, 1e-9);
  ASSERT_EQ(decode_position({}, extended(0x2a68, "fffffc18"), position_rad), DecodeStatus::ok);
  EXPECT_NEAR(position_rad, -10 * kDegree, 1e-12);
  EXPECT_TRUE(is_start({}, extended(0x2c68, "fafbfcfd")));
  EXPECT_FALSE(is_start({}, extended(0x2c68, "00fbfcfd")));
}

TEST(Ak, SignsAreThoseOfTwosComplement) {
  AkStatus status;
  ASSERT_EQ(decode_status({.pole_pairs = 14, .gear_ratio = 6}, extended(0x2968, "fc18ff38fe0cec00"), status),
            DecodeStatus::ok);
  EXPECT_NEAR(status.position_rad, -100 * kDegree, 1e-12);
  EXPECT_NEAR(status.velocity_rad_s, -2000.0 / 14 / 6 * 2 * std::numbers::pi / 60, 1e-12)
      << "an AK60-6: 14 pole pairs, 6:1";
  EXPECT_NEAR(status.current_A, -5, 1e-12);
  EXPECT_EQ(status.driver_temperature_C, -20);
}

TEST(Ak, EveryNumberOfAFaultHasItsName) {
  constexpr std::array kFaults{DriverFault::none,
                               DriverFault::motor_over_temperature,
                               DriverFault::over_current,
                               DriverFault::over_voltage,
                               DriverFault::under_voltage,
                               DriverFault::encoder,
                               DriverFault::driver_over_temperature,
                               DriverFault::overload};
  for (std::uint8_t code = 0; code < 8; ++code) {
    CanFrame frame;
    ASSERT_EQ(encode_status({}, {.code = code}, frame), EncodeStatus::ok);
    AkStatus status;
    ASSERT_EQ(decode_status({}, frame, status), DecodeStatus::ok);
    EXPECT_EQ(status.fault, kFaults[code]);
    EXPECT_EQ(status.code, code);
    if (code > 0) {
      EXPECT_EQ(ak_code(kFaults[code]), code);
    }
  }
  EXPECT_EQ(ak_code(DriverFault::gate_driver), 7) << "it has no number for that";
  AkStatus status;
  ASSERT_EQ(decode_status({}, extended(0x2968, "0000000000000008"), status), DecodeStatus::ok);
  EXPECT_EQ(status.fault, DriverFault::other);
  ASSERT_EQ(decode_status({}, extended(0x2968, "0000000000000077"), status), DecodeStatus::ok);
  EXPECT_EQ(status.fault, DriverFault::none) << "it confirms that it was disabled";
  EXPECT_TRUE(status.disabled);
}

TEST(Ak, ALimpCommandHasNoGainAndNoTorqueByEitherScale) {
  CanFrame frame;
  ASSERT_EQ(encode_limp({.torque_Nm = 54}, frame), EncodeStatus::ok);
  EXPECT_EQ(hex(frame), "0000007fff7ff7ff");
  AkCodes codes;
  ASSERT_EQ(decode_codes(0x68, frame, codes), DecodeStatus::ok);
  EXPECT_TRUE(limp(codes));
  for (const bool whole_scale : {false, true}) {
    const AkCommand command = command_of({.torque_Nm = 54}, codes, whole_scale);
    EXPECT_EQ(command.kp_Nm_rad, 0);
    EXPECT_EQ(command.kd_Nms_rad, 0);
    EXPECT_LE(std::abs(command.torque_Nm), 54.0 / 2048);
  }
  for (const char* pushes :
       {"0010007fff7ff7ff", "0000017fff7ff7ff", "0000007fff7ff7fe", "0000007fff7ff801"}) {
    ASSERT_EQ(decode_codes(0x68, extended(0x868, pushes), codes), DecodeStatus::ok);
    EXPECT_FALSE(limp(codes)) << pushes;
  }
}

// The safety audit of an AK60-6: what version 2 takes for "motor on" is a command of all that it has.
TEST(Ak, TheSpecialFramesOfVersionTwoAreCommandsOfFullTorque) {
  AkCodes codes;
  ASSERT_EQ(decode_codes(0x68, extended(0x868, "fffffffffffffffc"), codes), DecodeStatus::ok);
  const AkCommand command = command_of({.torque_Nm = 12}, codes, false);
  EXPECT_EQ(command.kp_Nm_rad, 500);
  EXPECT_NEAR(command.position_rad, 12.56, 1e-9);
  EXPECT_NEAR(command.torque_Nm, 12, 0.02);
}

// 3 bytes to such a driver drew 62.5 A, by a public record of one (force control of DASH-01).
TEST(Ak, MissingBytesOfACommandAreZerosToTheDriver) {
  AkCodes codes;
  ASSERT_EQ(decode_codes(0x68, extended(0x868, "640000"), codes), DecodeStatus::ok);
  EXPECT_NEAR(command_of({}, codes, false).position_rad, -12.56, 1e-9);
  EXPECT_GT(command_of({}, codes, false).kp_Nm_rad, 100);
  AkCommand command;
  EXPECT_EQ(decode_command({}, extended(0x868, "640000"), command), DecodeStatus::wrong_length);
}

TEST(Ak, AnOriginIsOneByte) {
  EXPECT_EQ(hex(origin_frame({}, true)), "01");
  EXPECT_EQ(hex(origin_frame({}, false)), "00");
  EXPECT_EQ(origin_frame({}, true).id, 0x568u);
  EXPECT_TRUE(origin_frame({}, true).extended);
}

TEST(Ak, EveryCommandComesBackWithinOneStepBelow) {
  constexpr std::uint64_t kSeed = 5101;
  SCOPED_TRACE(kSeed);
  RandomValues random(kSeed);
  for (int i = 0; i < 100'000; ++i) {
    AkDriver driver;
    driver.id = static_cast<std::uint8_t>(random.below(256));
    driver.velocity_rad_s = random.between(1, 100);
    driver.torque_Nm = random.between(1, 200);
    const AkCommand command{
        random.between(-12.56, 12.56), random.between(-driver.velocity_rad_s, driver.velocity_rad_s),
        random.between(0, 500), random.between(0, 5), random.between(-driver.torque_Nm, driver.torque_Nm)};
    CanFrame frame;
    ASSERT_EQ(encode_command(driver, command, frame), EncodeStatus::ok);
    ASSERT_EQ(frame.length, 8);
    AkCommand back;
    ASSERT_EQ(decode_command(driver, frame, back), DecodeStatus::ok);
    const auto expect_cut_off = [](double sent, double received, double step) {
      ASSERT_LE(received, sent + 2e-6 * step);
      ASSERT_GT(received, sent - 1.000001 * step);
    };
    expect_cut_off(command.position_rad, back.position_rad, 25.12 / 65535);
    expect_cut_off(command.velocity_rad_s, back.velocity_rad_s, 2 * driver.velocity_rad_s / 4095);
    expect_cut_off(command.kp_Nm_rad, back.kp_Nm_rad, 500.0 / 4095);
    expect_cut_off(command.kd_Nms_rad, back.kd_Nms_rad, 5.0 / 4095);
    expect_cut_off(command.torque_Nm, back.torque_Nm, 2 * driver.torque_Nm / 4095);
    CanFrame again;
    ASSERT_EQ(encode_command(driver, back, again), EncodeStatus::ok);
    ASSERT_EQ(again, frame) << "a decoded command encodes to the same bytes";
    AkCodes codes;
    ASSERT_EQ(decode_codes(driver.id, frame, codes), DecodeStatus::ok);
    const AkCommand whole = command_of(driver, codes, true);
    ASSERT_NEAR(whole.position_rad, back.position_rad, 25.12 / 65535) << "the other scale is a step away";
    ASSERT_NEAR(whole.torque_Nm, back.torque_Nm, 2 * driver.torque_Nm / 4095);
  }
}

TEST(Ak, EveryReportComesBack) {
  constexpr std::uint64_t kSeed = 5102;
  SCOPED_TRACE(kSeed);
  RandomValues random(kSeed);
  for (int i = 0; i < 50'000; ++i) {
    AkDriver driver;
    driver.id = static_cast<std::uint8_t>(random.below(256));
    driver.pole_pairs = 1 + static_cast<int>(random.below(40));
    driver.gear_ratio = random.between(1, 64);
    const double speed_step_rad_s = 10 * 2 * std::numbers::pi / 60 / driver.pole_pairs / driver.gear_ratio;
    const AkStatus status{.position_rad = random.between(-3200, 3200) * kDegree,
                          .velocity_rad_s = random.between(-32'000, 32'000) * speed_step_rad_s,
                          .current_A = random.between(-60, 60),
                          .driver_temperature_C = random.between(-20, 127),
                          .code = static_cast<std::uint8_t>(random.below(8))};
    CanFrame frame;
    ASSERT_EQ(encode_status(driver, status, frame), EncodeStatus::ok);
    AkStatus back;
    ASSERT_EQ(decode_status(driver, frame, back), DecodeStatus::ok);
    ASSERT_NEAR(back.position_rad, status.position_rad, 0.1 * kDegree);
    ASSERT_NEAR(back.velocity_rad_s, status.velocity_rad_s, speed_step_rad_s);
    ASSERT_NEAR(back.current_A, status.current_A, 0.01);
    ASSERT_NEAR(back.driver_temperature_C, status.driver_temperature_C, 1);
    ASSERT_EQ(back.code, status.code);
    CanFrame again;
    ASSERT_EQ(encode_status(driver, back, again), EncodeStatus::ok);
    ASSERT_EQ(again, frame);
    double position_rad = 0;
    const auto length = static_cast<std::uint8_t>(random.chance(0.5) ? 4 : 8);
    ASSERT_EQ(encode_position(driver, status.position_rad, length, frame), EncodeStatus::ok);
    ASSERT_EQ(decode_position(driver, frame, position_rad), DecodeStatus::ok);
    ASSERT_NEAR(position_rad, status.position_rad, 0.01 * kDegree);
  }
}

TEST(Ak, WhatIsBeyondARangeSaturates) {
  CanFrame frame;
  AkCommand back;
  EXPECT_EQ(encode_command({}, {.position_rad = 20, .kp_Nm_rad = -1, .torque_Nm = -99}, frame),
            EncodeStatus::saturated);
  ASSERT_EQ(decode_command({}, frame, back), DecodeStatus::ok);
  EXPECT_NEAR(back.position_rad, 12.56, 1e-9);
  EXPECT_EQ(back.kp_Nm_rad, 0);
  EXPECT_NEAR(back.torque_Nm, -18, 1e-9);
  EXPECT_EQ(encode_status({}, {.position_rad = 100}, frame), EncodeStatus::saturated);
  AkStatus status;
  ASSERT_EQ(decode_status({}, frame, status), DecodeStatus::ok);
  EXPECT_NEAR(status.position_rad, 3276.7 * kDegree, 1e-9);
}

TEST(Ak, NothingThatIsNoNumberIsSent) {
  for (const double none : {kNaN, kInfinity, -kInfinity}) {
    const CanFrame before = extended(0x123, "55");
    for (const AkCommand& command :
         {AkCommand{.position_rad = none}, AkCommand{.velocity_rad_s = none}, AkCommand{.kp_Nm_rad = none},
          AkCommand{.kd_Nms_rad = none}, AkCommand{.torque_Nm = none}}) {
      CanFrame frame = before;
      EXPECT_EQ(encode_command({}, command, frame), EncodeStatus::not_finite);
      EXPECT_EQ(frame, before);
    }
    CanFrame frame;
    EXPECT_EQ(encode_status({}, {.velocity_rad_s = none}, frame), EncodeStatus::not_finite);
    EXPECT_EQ(encode_position({}, none, 4, frame), EncodeStatus::not_finite);
  }
}

TEST(Ak, ADriverThatMakesNoSenseIsInvalid) {
  EXPECT_TRUE(valid(AkDriver{}));
  for (const AkDriver& wrong :
       {AkDriver{.velocity_rad_s = 0}, AkDriver{.torque_Nm = kNaN}, AkDriver{.status_rate_hz = 0},
        AkDriver{.status_rate_hz = 501}, AkDriver{.pole_pairs = 0}, AkDriver{.gear_ratio = -9},
        AkDriver{.torque_constant_Nm_A = kNaN}}) {
    EXPECT_FALSE(valid(wrong));
    CanFrame frame;
    EXPECT_EQ(encode_limp(wrong, frame), EncodeStatus::invalid);
  }
}

TEST(Ak, FramesOfOthersAreNotAddressed) {
  constexpr std::uint64_t kSeed = 5103;
  SCOPED_TRACE(kSeed);
  RandomValues random(kSeed);
  CanFrame whole;
  ASSERT_EQ(encode_status({}, {.position_rad = 1}, whole), EncodeStatus::ok);
  AkStatus status{.position_rad = 1234};
  for (CanFrame frame : std::array{whole, whole, whole, whole, whole}) {
    switch (random.below(5)) {
      case 0:
        frame.extended = false;
        break;
      case 1:
        frame.remote = true;
        break;
      case 2:
        frame.fd = true;
        break;
      case 3:
        frame.error = true;
        break;
      default:
        frame.id ^= 1u << random.below(29);
        break;
    }
    EXPECT_EQ(decode_status({}, frame, status), DecodeStatus::not_addressed);
    EXPECT_EQ(status.position_rad, 1234);
  }
  whole.length = 7;
  EXPECT_EQ(decode_status({}, whole, status), DecodeStatus::wrong_length);
  double position_rad = 1234;
  EXPECT_EQ(decode_position({}, extended(0x2a68, "000102"), position_rad), DecodeStatus::wrong_length);
  EXPECT_EQ(position_rad, 1234);
}

}  // namespace
}  // namespace stilt::hal::ak
