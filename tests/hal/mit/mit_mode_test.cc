#include "hal/mit/mit_mode.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "tests/hal/hex.h"
#include "tests/hal/random_values.h"

namespace stilt::hal::mit {
namespace {

using stilt::hal::testing::hex;
using stilt::hal::testing::RandomValues;
using stilt::hal::testing::with_payload;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

MitDriver damiao() {
  MitDriver driver;
  driver.command_id = 1;
  driver.reply_id = 0x11;
  driver.layout = ReplyLayout::damiao;
  driver.velocity_rad_s = driver.reply_velocity_rad_s = {-30, 30};
  driver.torque_Nm = driver.reply_torque_Nm = {-10, 10};
  return driver;
}

MitDriver ak() {
  MitDriver driver;
  driver.layout = ReplyLayout::ak;
  return driver;
}

std::array<MitDriver, 3> all_layouts() { return {MitDriver{}, ak(), damiao()}; }

// Vectors printed in the vendors' and users' documents of the protocol; the zero command is the first frame
// of B. Katz's SPIne firmware and of Damiao's and OpenArm's protocol tests.
TEST(MitMode, APublishedZeroCommandIsReproduced) {
  CanFrame frame;
  EXPECT_EQ(encode_command(MitDriver{}, MitCommand{}, frame), EncodeStatus::ok);
  EXPECT_EQ(hex(frame), "7fff7ff0000007ff");
  EXPECT_EQ(frame.id, 1u);
  EXPECT_EQ(encode_command(damiao(), MitCommand{}, frame), EncodeStatus::ok);
  EXPECT_EQ(hex(frame), "7fff7ff0000007ff");
}

TEST(MitMode, APublishedPositionCommandIsReproduced) {
  CanFrame frame;
  EXPECT_EQ(encode_command(damiao(), {.position_rad = -0.6, .kp_Nm_rad = 100, .kd_Nms_rad = 2}, frame),
            EncodeStatus::ok);
  EXPECT_EQ(hex(frame), "79da7ff3336667ff") << "kp 819 = 0x333, kd 1638 = 0x666";
}

TEST(MitMode, SpecialFramesAreSevenFfAndALetter) {
  EXPECT_EQ(hex(special_frame(damiao(), MitSpecial::enter)), "fffffffffffffffc");
  EXPECT_EQ(hex(special_frame(damiao(), MitSpecial::leave)), "fffffffffffffffd");
  EXPECT_EQ(hex(special_frame(damiao(), MitSpecial::set_zero)), "fffffffffffffffe");
  EXPECT_EQ(hex(special_frame(damiao(), MitSpecial::clear_error)), "fffffffffffffffb");
  MitSpecial special{};
  EXPECT_EQ(decode_special(damiao(), special_frame(damiao(), MitSpecial::leave), special), DecodeStatus::ok);
  EXPECT_EQ(special, MitSpecial::leave);
}

TEST(MitMode, NoCommandCanBeMistakenForASpecialFrame) {
  const MitDriver driver = damiao();
  for (std::uint32_t code = 0xff0; code <= 0xfff; ++code) {
    const double torque_Nm = driver.torque_Nm.minimum + code * step(driver.torque_Nm, 12);
    CanFrame frame;
    const EncodeStatus status = encode_command(
        driver, {driver.position_rad.maximum, driver.velocity_rad_s.maximum, 500, 5, torque_Nm}, frame);
    ASSERT_TRUE(status == EncodeStatus::ok || status == EncodeStatus::saturated);
    MitSpecial special{};
    EXPECT_EQ(decode_special(driver, frame, special), DecodeStatus::malformed) << hex(frame);
    const std::string bytes = hex(frame);
    EXPECT_FALSE(bytes.starts_with("ffffffffffffff") && bytes >= "fffffffffffffffb" &&
                 bytes <= "fffffffffffffffe")
        << bytes;
    MitCommand back;
    ASSERT_EQ(decode_command(driver, frame, back), DecodeStatus::ok);
    EXPECT_NEAR(back.torque_Nm, torque_Nm, 1e-9);
    EXPECT_NEAR(back.kd_Nms_rad, 5, 1.01 * step(driver.kd_Nms_rad, 12));
  }
}

TEST(MitMode, EveryCommandComesBackWithinOneStepBelow) {
  constexpr std::uint64_t kSeed = 4101;
  SCOPED_TRACE(kSeed);
  RandomValues random(kSeed);
  for (const MitDriver& driver : all_layouts()) {
    for (int i = 0; i < 100'000; ++i) {
      const auto in = [&random](const Range& range) { return random.between(range.minimum, range.maximum); };
      const MitCommand command{in(driver.position_rad), in(driver.velocity_rad_s), in(driver.kp_Nm_rad),
                               in(driver.kd_Nms_rad), in(driver.torque_Nm)};
      CanFrame frame;
      ASSERT_EQ(encode_command(driver, command, frame), EncodeStatus::ok);
      MitCommand back;
      ASSERT_EQ(decode_command(driver, frame, back), DecodeStatus::ok);
      const auto expect_cut_off = [](double sent, double received, double one_step) {
        ASSERT_LE(received, sent + 2e-6 * one_step);
        ASSERT_GT(received, sent - 1.000001 * one_step);
      };
      expect_cut_off(command.position_rad, back.position_rad, step(driver.position_rad, 16));
      expect_cut_off(command.velocity_rad_s, back.velocity_rad_s, step(driver.velocity_rad_s, 12));
      expect_cut_off(command.kp_Nm_rad, back.kp_Nm_rad, step(driver.kp_Nm_rad, 12));
      expect_cut_off(command.kd_Nms_rad, back.kd_Nms_rad, step(driver.kd_Nms_rad, 12));
      expect_cut_off(command.torque_Nm, back.torque_Nm, step(driver.torque_Nm, 12));
      CanFrame again;
      ASSERT_EQ(encode_command(driver, back, again), EncodeStatus::ok);
      ASSERT_EQ(again, frame) << "a decoded command encodes to the same bytes";
    }
  }
}

TEST(MitMode, EveryCodeOfEveryFieldSurvivesDecodingAndEncoding) {
  const MitDriver driver = damiao();
  for (std::uint32_t code = 0; code <= 0xffff; ++code) {
    CanFrame frame = classic_frame(1, 8);
    frame.data = {static_cast<std::uint8_t>(code >> 8),
                  static_cast<std::uint8_t>(code),
                  static_cast<std::uint8_t>(code >> 8),
                  static_cast<std::uint8_t>((code & 0xf0) | (code >> 12)),
                  static_cast<std::uint8_t>(code >> 4),
                  static_cast<std::uint8_t>(code >> 8),
                  static_cast<std::uint8_t>((code & 0xf0) | (code >> 12)),
                  static_cast<std::uint8_t>(code >> 4)};
    MitCommand command;
    if (decode_command(driver, frame, command) != DecodeStatus::ok) continue;  // a special frame
    CanFrame again;
    ASSERT_EQ(encode_command(driver, command, again), EncodeStatus::ok) << code;
    ASSERT_EQ(again, frame) << code;
  }
}

TEST(MitMode, RepliesOfEveryLayoutComeBack) {
  constexpr std::uint64_t kSeed = 4102;
  SCOPED_TRACE(kSeed);
  RandomValues random(kSeed);
  for (const MitDriver& driver : all_layouts()) {
    for (int i = 0; i < 50'000; ++i) {
      const auto in = [&random](const Range& range) { return random.between(range.minimum, range.maximum); };
      MitReply reply;
      reply.position_rad = in(driver.reply_position_rad);
      reply.velocity_rad_s = in(driver.reply_velocity_rad_s);
      reply.torque_Nm = in(driver.reply_torque_Nm);
      reply.supply_V = random.chance(0.5) ? in(driver.supply_V) : kNaN;
      reply.driver_temperature_C = random.below(100);
      reply.motor_temperature_C = random.below(100);
      reply.fault_code = static_cast<std::uint8_t>(random.below(16));
      CanFrame frame;
      ASSERT_EQ(encode_reply(driver, reply, frame), EncodeStatus::ok);
      MitReply back;
      ASSERT_EQ(decode_reply(driver, frame, back), DecodeStatus::ok);
      ASSERT_NEAR(back.position_rad, reply.position_rad, step(driver.reply_position_rad, 16));
      ASSERT_NEAR(back.velocity_rad_s, reply.velocity_rad_s, step(driver.reply_velocity_rad_s, 12));
      ASSERT_NEAR(back.torque_Nm, reply.torque_Nm, step(driver.reply_torque_Nm, 12));
      CanFrame again;
      ASSERT_EQ(encode_reply(driver, back, again), EncodeStatus::ok);
      ASSERT_EQ(again, frame);
    }
  }
}

TEST(MitMode, TheRangesOfAReplyMayDifferFromTheCommands) {
  MitDriver driver;
  driver.reply_position_rad = {-3, 5};
  driver.reply_velocity_rad_s = {-20, 30};
  driver.reply_torque_Nm = {-40, 50};
  MitReply reply;
  ASSERT_EQ(decode_reply(driver, with_payload(classic_frame(0, 6), "01 ffff fff fff"), reply),
            DecodeStatus::ok);
  EXPECT_DOUBLE_EQ(reply.position_rad, 5);
  EXPECT_DOUBLE_EQ(reply.velocity_rad_s, 30);
  EXPECT_DOUBLE_EQ(reply.torque_Nm, 50);
  reply.position_rad = 5;
  reply.velocity_rad_s = 30;
  reply.torque_Nm = 50;
  CanFrame frame;
  ASSERT_EQ(encode_reply(driver, reply, frame), EncodeStatus::ok);
  EXPECT_EQ(hex(frame), "01ffffffffff");
}

TEST(MitMode, MiniCheetahsReportTheirSupplyWhenTheyHaveASeventhByte) {
  MitReply reply;
  ASSERT_EQ(decode_reply({}, with_payload(classic_frame(0, 6), "01 7fff 7ff 7ff"), reply), DecodeStatus::ok);
  EXPECT_TRUE(std::isnan(reply.supply_V));
  ASSERT_EQ(decode_reply({}, with_payload(classic_frame(0, 7), "01 7fff 7ff 7ff 99"), reply),
            DecodeStatus::ok);
  EXPECT_DOUBLE_EQ(reply.supply_V, 24);
}

// CubeMars AK series manual 1.0.17: -40 to 215 C.
TEST(MitMode, AkTemperatureIsItsByteLess40AndHasNoSign) {
  const auto of_byte = [](const MitDriver& driver, std::string_view byte) {
    MitReply reply;
    EXPECT_EQ(
        decode_reply(
            driver, with_payload(classic_frame(0, 8), "01 7fff 7ff 7ff " + std::string(byte) + " 03"), reply),
        DecodeStatus::ok);
    EXPECT_EQ(reply.fault, DriverFault::over_voltage);
    return reply.driver_temperature_C;
  };
  EXPECT_EQ(of_byte(ak(), "00"), -40);
  EXPECT_EQ(of_byte(ak(), "46"), 30);
  EXPECT_EQ(of_byte(ak(), "80"), 88) << "not -168";
  EXPECT_EQ(of_byte(ak(), "ff"), 215);
  MitDriver unshifted = ak();
  unshifted.temperature_offset_C = 0;
  EXPECT_EQ(of_byte(unshifted, "fb"), 251);
}

TEST(MitMode, DamiaoStatusIsInTheHighHalfOfTheFirstByte) {
  MitReply reply;
  const CanFrame frame = with_payload(classic_frame(0x11, 8), "d1 8000 800 7ff 28 1e");
  ASSERT_EQ(decode_reply(damiao(), frame, reply), DecodeStatus::ok);
  EXPECT_EQ(reply.fault_code, 0xd);
  EXPECT_EQ(reply.fault, DriverFault::lost_communication);
  EXPECT_FALSE(reply.enabled);
  EXPECT_EQ(reply.driver_temperature_C, 40);
  EXPECT_EQ(reply.motor_temperature_C, 30);
  ASSERT_EQ(decode_reply(damiao(), with_payload(frame, "11 8000 800 7ff 28 1e"), reply), DecodeStatus::ok);
  EXPECT_TRUE(reply.enabled);
  EXPECT_EQ(reply.fault, DriverFault::none);
}

TEST(MitMode, ValuesBeyondTheRangeStopAtItsEnd) {
  CanFrame frame;
  EXPECT_EQ(encode_command({}, {.position_rad = 100, .velocity_rad_s = -1e9, .torque_Nm = 1e300}, frame),
            EncodeStatus::saturated);
  MitCommand back;
  ASSERT_EQ(decode_command({}, frame, back), DecodeStatus::ok);
  EXPECT_DOUBLE_EQ(back.position_rad, 12.5);
  EXPECT_DOUBLE_EQ(back.velocity_rad_s, -65);
  EXPECT_DOUBLE_EQ(back.torque_Nm, 18);
}

TEST(MitMode, WhatIsNotFiniteIsNotSent) {
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    for (int field = 0; field < 5; ++field) {
      MitCommand command;
      std::array<double*, 5>{&command.position_rad, &command.velocity_rad_s, &command.kp_Nm_rad,
                             &command.kd_Nms_rad, &command.torque_Nm}[static_cast<std::size_t>(field)][0] =
          bad;
      CanFrame frame = classic_frame(0x123, 3);
      EXPECT_EQ(encode_command({}, command, frame), EncodeStatus::not_finite);
      EXPECT_EQ(frame, classic_frame(0x123, 3)) << "the frame stays as it was";
    }
  }
}

TEST(MitMode, ADriverWithoutSenseIsRefused) {
  CanFrame frame;
  MitDriver driver;
  driver.position_rad = {1, 1};
  EXPECT_EQ(encode_command(driver, {}, frame), EncodeStatus::invalid);
  driver = {};
  driver.command_id = 0x800;
  EXPECT_EQ(encode_command(driver, {}, frame), EncodeStatus::invalid);
  driver = damiao();
  driver.driver_id = 0x10;
  EXPECT_FALSE(valid(driver)) << "Damiao has four bits for the identifier";
}

TEST(MitMode, RepliesThatDoNotFitAreNamed) {
  MitReply reply;
  const CanFrame good = with_payload(classic_frame(0, 6), "01 7fff 7ff 7ff");
  for (std::uint8_t length = 0; length <= 8; ++length) {
    CanFrame frame = good;
    frame.length = length;
    EXPECT_EQ(decode_reply({}, frame, reply),
              length == 6 || length == 7 ? DecodeStatus::ok : DecodeStatus::wrong_length);
  }
  CanFrame frame = good;
  frame.id = 5;
  EXPECT_EQ(decode_reply({}, frame, reply), DecodeStatus::not_addressed);
  frame = good;
  frame.data[0] = 2;
  EXPECT_EQ(decode_reply({}, frame, reply), DecodeStatus::not_addressed)
      << "another driver with the same reply identifier";
  for (bool CanFrame::* flag : {&CanFrame::extended, &CanFrame::remote, &CanFrame::error, &CanFrame::fd}) {
    frame = good;
    frame.*flag = true;
    EXPECT_EQ(decode_reply({}, frame, reply), DecodeStatus::not_addressed);
  }
}

}  // namespace
}  // namespace stilt::hal::mit
