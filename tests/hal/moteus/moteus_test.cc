#include "hal/moteus/moteus.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>

#include "hal/moteus/moteus_driver.h"
#include "tests/hal/hex.h"
#include "tests/hal/random_values.h"

namespace stilt::hal::moteus {
namespace {

using stilt::hal::testing::hex;
using stilt::hal::testing::RandomValues;
using stilt::hal::testing::with_payload;

constexpr double kTurn = 2 * std::numbers::pi;

CanFrame reply_frame(std::string_view digits) {
  CanFrame frame;
  frame.id = 0x100;
  frame.fd = true;
  return with_payload(frame, digits);
}

// docs/protocol/can.md of mjbots/moteus, "Example".
TEST(Moteus, ThePublishedCommandIsReproduced) {
  CanFrame frame;
  SubframeWriter writer(frame);
  const double mode = 10;
  writer.values(SubframeKind::write, MoteusRegister::mode, Resolution::int8, std::span(&mode, 1));
  const std::array<double, 3> values{96 * 1e-4, 288 * 2.5e-4, -1.76};
  writer.values(SubframeKind::write, MoteusRegister::command_position, Resolution::int16, values);
  writer.read(MoteusRegister::mode, Resolution::int16, 4);
  writer.read(MoteusRegister::voltage, Resolution::int8, 3);
  ASSERT_EQ(writer.finish(), EncodeStatus::ok);
  EXPECT_EQ(hex(frame), "01000a07206000200150ff140400130d");
}

TEST(Moteus, ThePublishedReplyIsUnderstood) {
  MoteusReply reply;
  ASSERT_EQ(decode_reply({}, reply_frame("2404000a005000000170ff230d181400"), reply), DecodeStatus::ok);
  EXPECT_EQ(reply.mode, 10);
  EXPECT_NEAR(reply.position_rad, 2.88 / 180 * std::numbers::pi, 1e-12);
  EXPECT_NEAR(reply.velocity_rad_s, 23.04 / 180 * std::numbers::pi, 1e-12);
  EXPECT_DOUBLE_EQ(reply.torque_Nm, -1.44);
  EXPECT_EQ(reply.voltage_V, 12);
  EXPECT_EQ(reply.temperature_C, 20);
  EXPECT_TRUE(reply.has_fault);
  EXPECT_EQ(reply.fault_code, 0);
  EXPECT_FALSE(reply.has_home);
}

// Bytes that mjbots' own moteus_protocol.h gives for the same registers in float.
TEST(Moteus, ThePublishedFloatCommandIsReproduced) {
  CanFrame frame;
  SubframeWriter writer(frame);
  const auto write = [&writer](MoteusRegister start, Resolution resolution,
                               std::initializer_list<double> values) {
    writer.values(SubframeKind::write, start, resolution, std::span(values.begin(), values.size()));
  };
  write(MoteusRegister::mode, Resolution::int8, {10});
  write(MoteusRegister::command_position, Resolution::real, {1.25, 0});
  write(MoteusRegister::command_maximum_torque, Resolution::real, {0.5});
  write(MoteusRegister::command_timeout, Resolution::real, {0.1, 2, 10});
  writer.read(MoteusRegister::mode, Resolution::int8, 1);
  writer.read(MoteusRegister::position, Resolution::real, 3);
  writer.read(MoteusRegister::home_state, Resolution::int8, 1);
  writer.read(MoteusRegister::voltage, Resolution::real, 2);
  writer.read(MoteusRegister::fault, Resolution::int8, 1);
  ASSERT_EQ(writer.finish(), EncodeStatus::ok);
  EXPECT_EQ(hex(frame),
            "01000a0e200000a03f000000000d250000003f0f27cdcccc3d00000040000020411100"
            "1f01110c1e0d110f5050505050");
}

TEST(Moteus, RegistersBeyondSevenBitsTakeTwoBytes) {
  CanFrame frame;
  SubframeWriter writer(frame);
  const double zero = 0;
  writer.values(SubframeKind::write, static_cast<MoteusRegister>(0x131), Resolution::real,
                std::span(&zero, 1));
  ASSERT_EQ(writer.finish(), EncodeStatus::ok);
  EXPECT_EQ(hex(frame), "0db10200000000");
}

TEST(Moteus, ACommandIs32BytesAndAsksForAReply) {
  CanFrame frame;
  ASSERT_EQ(encode_command({.id = 5, .source = 2}, {.position_rad = 0.5 * kTurn, .kp_Nm_rad = 0.1}, frame),
            EncodeStatus::ok);
  EXPECT_EQ(frame.id, 0x8205u);
  EXPECT_TRUE(frame.extended && frame.fd && frame.bit_rate_switch);
  EXPECT_EQ(frame.length, 32);
  EXPECT_TRUE(well_formed(frame));
  ASSERT_EQ(encode_command({.id = 5, .extra_encoder = 2}, {}, frame), EncodeStatus::ok);
  EXPECT_EQ(frame.length, 32);
}

/// Registers of an emulated driver.
struct Registers {
  std::map<std::uint32_t, double> value;
  static double read(const void* context, std::uint32_t number) noexcept {
    const auto& value = static_cast<const Registers*>(context)->value;
    const auto found = value.find(number);
    return found == value.end() ? std::numeric_limits<double>::quiet_NaN() : found->second;
  }
  static void write(void* context, std::uint32_t number, double value) noexcept {
    static_cast<Registers*>(context)->value[number] = value;
  }
};

TEST(Moteus, CommandsArriveInTheRegistersAndStateComesBack) {
  constexpr std::uint64_t kSeed = 4201;
  SCOPED_TRACE(kSeed);
  RandomValues random(kSeed);
  const MoteusDriver driver{.id = 3, .source = 1, .kp_Nm_rev = 500, .kd_Nm_s_rev = 20, .extra_encoder = 1};
  for (int i = 0; i < 20'000; ++i) {
    const MoteusCommand command{random.between(-20, 20),
                                random.between(-50, 50),
                                random.between(-100, 100),
                                random.between(0, 79),
                                random.between(0, 3),
                                random.between(0, 300),
                                0.02};
    CanFrame frame;
    ASSERT_EQ(encode_command(driver, command, frame), EncodeStatus::ok);
    Registers registers;
    auto& value = registers.value;
    value[0x001] = random.between(-100, 100);
    value[0x002] = random.between(-80, 80);
    value[0x003] = random.between(-300, 300);
    value[0x00d] = 24;
    value[0x00e] = 31;
    value[0x00f] = 0;
    value[0x052] = random.between(-100, 100);
    value[0x053] = random.between(-8, 8);
    CanFrame answer;
    bool answered = false;
    ASSERT_EQ(serve_frame(driver, frame, &registers, Registers::read, Registers::write, answer, answered),
              DecodeStatus::ok);
    ASSERT_TRUE(answered);
    ASSERT_EQ(answer.id, 0x301u);
    ASSERT_EQ(answer.length, 48);
    ASSERT_EQ(value[0x000], 10);
    ASSERT_NEAR(value[0x020] * kTurn, command.position_rad, 0.5001e-4 * kTurn);
    ASSERT_NEAR(value[0x021] * kTurn, command.velocity_rad_s, 0.5001 * 2.5e-4 * kTurn);
    ASSERT_NEAR(value[0x022], command.torque_Nm, 0.005001);
    ASSERT_NEAR(value[0x023] * driver.kp_Nm_rev / kTurn, command.kp_Nm_rad, 80.0 / 65534);
    ASSERT_NEAR(value[0x024] * driver.kd_Nm_s_rev / kTurn, command.kd_Nms_rad, 3.2 / 65534);
    ASSERT_NEAR(value[0x025], command.maximum_torque_Nm, 0.005001);
    ASSERT_NEAR(value[0x027], 0.02, 1e-12);
    ASSERT_LT(value[0x029], 0) << "no limit of the acceleration";
    MoteusReply reply;
    ASSERT_EQ(decode_reply(driver, answer, reply), DecodeStatus::ok);
    ASSERT_EQ(reply.mode, 10);
    ASSERT_NEAR(reply.position_rad, value[0x001] * kTurn, 0.5001e-5 * kTurn);
    ASSERT_NEAR(reply.velocity_rad_s, value[0x002] * kTurn, 0.5001e-5 * kTurn);
    ASSERT_NEAR(reply.torque_Nm, value[0x003], 0.0005001);
    ASSERT_NEAR(reply.encoder_position_rad[1], value[0x052] * kTurn, 0.5001e-5 * kTurn);
    ASSERT_NEAR(reply.encoder_velocity_rad_s[1], value[0x053] * kTurn, 0.5001e-5 * kTurn);
    ASSERT_TRUE(std::isnan(reply.encoder_position_rad[0]));
    ASSERT_EQ(reply.voltage_V, 24);
  }
}

// kp / (2 pi) * (2 pi) / kp is 1 + 2^-52 for one in ten of them.
TEST(Moteus, TheDriversOwnGainsSaturateNothing) {
  for (int i = 1; i <= 40'000; ++i) {
    const MoteusDriver driver{.kp_Nm_rev = 0.25 * i, .kd_Nm_s_rev = 0.01 * i};
    const double kp_Nm_rad = driver.kp_Nm_rev / kTurn, kd_Nms_rad = driver.kd_Nm_s_rev / kTurn;
    CanFrame frame;
    ASSERT_EQ(encode_command(driver, {.kp_Nm_rad = kp_Nm_rad, .kd_Nms_rad = kd_Nms_rad}, frame),
              EncodeStatus::ok)
        << driver.kp_Nm_rev;
    ASSERT_EQ(encode_command(driver, {.kp_Nm_rad = 1.00002 * kp_Nm_rad}, frame), EncodeStatus::saturated);
    ASSERT_EQ(encode_command(driver, {.kd_Nms_rad = 1.00002 * kd_Nms_rad}, frame), EncodeStatus::saturated);
    ASSERT_EQ(encode_command(driver, {.kp_Nm_rad = -1e-4 * kp_Nm_rad}, frame), EncodeStatus::saturated);
  }
}

TEST(Moteus, EveryIntegerOfEveryResolutionComesBack) {
  for (const Resolution resolution : {Resolution::int8, Resolution::int16}) {
    const int top = resolution == Resolution::int8 ? 127 : 32767;
    for (const MoteusRegister where :
         {MoteusRegister::position, MoteusRegister::velocity, MoteusRegister::torque, MoteusRegister::voltage,
          MoteusRegister::temperature, MoteusRegister::command_kp_scale, MoteusRegister::command_timeout}) {
      for (int integer = -top; integer <= top; ++integer) {
        const double value = integer * unit_of(static_cast<std::uint32_t>(where), resolution);
        CanFrame frame;
        SubframeWriter writer(frame);
        writer.values(SubframeKind::reply, where, resolution, std::span(&value, 1));
        ASSERT_EQ(writer.finish(), EncodeStatus::ok);
        SubframeReader reader(frame.payload());
        Subframe subframe;
        ASSERT_TRUE(reader.next(subframe));
        ASSERT_EQ(value_of(subframe, 0), value) << integer;
      }
    }
  }
}

TEST(Moteus, UnsetIsTheMostNegativeIntegerOrNaN) {
  CanFrame frame;
  ASSERT_EQ(encode_command({}, {}, frame), EncodeStatus::ok);
  SubframeReader reader(frame.payload());
  Subframe subframe;
  ASSERT_TRUE(reader.next(subframe));
  ASSERT_TRUE(reader.next(subframe));
  EXPECT_EQ(subframe.start, 0x20u);
  EXPECT_TRUE(std::isnan(value_of(subframe, 0))) << "position";
  EXPECT_EQ(value_of(subframe, 1), 0);
  EXPECT_TRUE(std::isnan(value_of(subframe, 5))) << "maximum torque";
  MoteusReply reply;
  ASSERT_EQ(decode_reply({}, reply_frame("290100000080"), reply), DecodeStatus::ok);
  EXPECT_TRUE(std::isnan(reply.position_rad));
  ASSERT_EQ(decode_reply({}, reply_frame("2d010000c07f"), reply), DecodeStatus::ok);
  EXPECT_TRUE(std::isnan(reply.position_rad));
}

TEST(Moteus, ValuesBeyondTheResolutionSaturateAndNeverTurnIntoUnset) {
  CanFrame frame;
  EXPECT_EQ(encode_command({}, {.position_rad = -1e6, .torque_Nm = 1e9}, frame), EncodeStatus::saturated);
  SubframeReader reader(frame.payload());
  Subframe subframe;
  ASSERT_TRUE(reader.next(subframe) && reader.next(subframe));
  EXPECT_NEAR(value_of(subframe, 0), -3.2767, 1e-12);
  EXPECT_NEAR(value_of(subframe, 2), 327.67, 1e-12);
  EXPECT_EQ(encode_command({.kp_Nm_rev = 1}, {.kp_Nm_rad = 1}, frame), EncodeStatus::saturated)
      << "a gain above the driver's own";
  EXPECT_EQ(encode_command({}, {.kp_Nm_rad = -1}, frame), EncodeStatus::saturated);
}

TEST(Moteus, AWatchdogBelowOneMillisecondIsWrittenAsOne) {
  // Zero would mean the driver's default; the register's unit is 1 ms.
  const auto written_s = [](const CanFrame& frame) {
    Registers registers;
    CanFrame answer;
    bool answered = false;
    EXPECT_EQ(serve_frame({}, frame, &registers, Registers::read, Registers::write, answer, answered),
              DecodeStatus::ok);
    return registers.value.at(0x027);
  };
  CanFrame frame;
  for (const double watchdog_s : {0.0, -1.0, 0.0004}) {
    EXPECT_EQ(encode_command({}, {.watchdog_s = watchdog_s}, frame), EncodeStatus::saturated);
    EXPECT_DOUBLE_EQ(written_s(frame), 0.001);
    EXPECT_EQ(encode_watchdog({}, watchdog_s, frame), EncodeStatus::saturated);
    EXPECT_DOUBLE_EQ(written_s(frame), 0.001);
  }
  EXPECT_EQ(encode_watchdog({}, 0.02, frame), EncodeStatus::ok);
  EXPECT_DOUBLE_EQ(written_s(frame), 0.02);
}

TEST(Moteus, WhatIsNotFiniteIsNotSent) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  CanFrame frame;
  EXPECT_EQ(encode_command({}, {.position_rad = kInfinity}, frame), EncodeStatus::not_finite);
  EXPECT_EQ(encode_command({}, {.velocity_rad_s = kNaN}, frame), EncodeStatus::not_finite);
  EXPECT_EQ(encode_command({}, {.torque_Nm = kNaN}, frame), EncodeStatus::not_finite);
  EXPECT_EQ(encode_command({}, {.kp_Nm_rad = kNaN}, frame), EncodeStatus::not_finite);
  EXPECT_EQ(encode_command({}, {.kd_Nms_rad = kNaN}, frame), EncodeStatus::not_finite);
  EXPECT_EQ(encode_command({}, {.watchdog_s = kNaN}, frame), EncodeStatus::not_finite)
      << "NaN would switch the watchdog off";
  EXPECT_EQ(encode_watchdog({}, kNaN, frame), EncodeStatus::not_finite);
  EXPECT_EQ(frame, CanFrame{});
}

TEST(Moteus, RepliesThatDoNotFitAreNamed) {
  MoteusReply reply;
  reply.mode = 77;
  EXPECT_EQ(decode_reply({}, reply_frame("2f010000"), reply), DecodeStatus::malformed)
      << "three floats cut off";
  EXPECT_EQ(decode_reply({}, reply_frame("6000"), reply), DecodeStatus::malformed) << "unknown type";
  EXPECT_EQ(decode_reply({}, reply_frame("20ffffffffff"), reply), DecodeStatus::malformed)
      << "endless number";
  EXPECT_EQ(decode_reply({}, reply_frame("200001"), reply), DecodeStatus::malformed) << "no registers at all";
  EXPECT_EQ(decode_reply({}, reply_frame("21"), reply), DecodeStatus::malformed) << "no register";
  EXPECT_EQ(decode_reply({}, reply_frame("01000a"), reply), DecodeStatus::malformed) << "a write is no reply";
  EXPECT_EQ(decode_reply({}, reply_frame("2d000000c07f"), reply), DecodeStatus::not_finite) << "mode NaN";
  EXPECT_EQ(reply.mode, 77) << "the output stays as it was";
  CanFrame frame = reply_frame("21000a");
  frame.id = 0x200;
  EXPECT_EQ(decode_reply({}, frame, reply), DecodeStatus::not_addressed);
}

TEST(Moteus, AnErrorSubframeIsReportedAndTheRestStillRead) {
  MoteusReply reply;
  ASSERT_EQ(decode_reply({}, reply_frame("310c0221000a5050"), reply), DecodeStatus::ok);
  EXPECT_TRUE(reply.register_error);
  EXPECT_EQ(reply.mode, 10);
}

TEST(Moteus, OnlyAModeThatFollowsCommandsCountsAsEnabled) {
  for (int mode = 0; mode <= 15; ++mode) {
    char digits[16];
    std::snprintf(digits, sizeof digits, "2100%02x210f00", mode);
    DriverReading reading;
    ASSERT_EQ(take_frame({}, reply_frame(digits), reading), DecodeStatus::ok);
    const bool faulty = mode == 1 || mode == 11;
    const bool follows = mode == 10 || mode == 12;
    EXPECT_EQ(reading.state, faulty    ? DriverState::fault
                             : follows ? DriverState::enabled
                                       : DriverState::idle)
        << mode;
  }
}

TEST(Moteus, FaultCodesFrom96AreLimitsNotFaults) {
  EXPECT_EQ(moteus_fault(0), DriverFault::none);
  EXPECT_EQ(moteus_fault(34), DriverFault::over_voltage);
  EXPECT_EQ(moteus_fault(38), DriverFault::driver_over_temperature);
  EXPECT_EQ(moteus_fault(102), DriverFault::none);
  EXPECT_EQ(moteus_fault(37), DriverFault::other);
  EXPECT_EQ(moteus_fault(32), DriverFault::configuration);
  EXPECT_EQ(moteus_fault(49), DriverFault::position_limit);
  EXPECT_EQ(moteus_fault(50), DriverFault::velocity_limit);
}

}  // namespace
}  // namespace stilt::hal::moteus
