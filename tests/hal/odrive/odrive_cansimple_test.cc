#include "hal/odrive/odrive_cansimple.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/hal/hex.h"
#include "tests/hal/random_values.h"

namespace stilt::hal::odrive {
namespace {

using stilt::hal::testing::hex;
using stilt::hal::testing::RandomValues;
using stilt::hal::testing::with_payload;

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(Odrive, TheIdentifierIsNodeAndCommand) {
  CanFrame frame;
  ASSERT_EQ(encode_input_position(1, 0, 0, 0, frame), EncodeStatus::ok);
  EXPECT_EQ(frame.id, 0x2cu) << "the example of the protocol's page";
  EXPECT_EQ(encode_input_position(64, 0, 0, 0, frame), EncodeStatus::invalid);
}

TEST(Odrive, RequestsAreRemoteFrames) {
  CanFrame frame;
  ASSERT_EQ(encode_request(3, OdriveCommand::version, frame), EncodeStatus::ok);
  EXPECT_EQ(frame.id, 0x60u);
  EXPECT_TRUE(frame.remote);
  EXPECT_EQ(frame.length, 0);
}

// ODriveResources examples: can_simple.py (state 8 as a little-endian word), can_param_access.py ('<BHB' and
// value).
TEST(Odrive, PublishedMessagesAreReproduced) {
  CanFrame frame;
  ASSERT_EQ(encode_set_state(0, 8, frame), EncodeStatus::ok);
  EXPECT_EQ(frame.id, 0x07u);
  EXPECT_EQ(hex(frame), "08000000");
  ASSERT_EQ(encode_set_controller_mode(0, OdriveControlMode::torque, OdriveInputMode::passthrough, frame),
            EncodeStatus::ok);
  EXPECT_EQ(hex(frame), "0100000001000000");
  ASSERT_EQ(encode_input_torque(0, 1, frame), EncodeStatus::ok);
  EXPECT_EQ(hex(frame), "0000803f");
  ASSERT_EQ(encode_parameter_request(0, {true, 0x0191, 0x3f9df3b6, 4}, frame), EncodeStatus::ok);
  EXPECT_EQ(hex(frame), "01910100b6f39d3f") << "1.234 to endpoint 0x191";
  ASSERT_EQ(encode_parameter_request(0, {false, 0x0191, 0, 4}, frame), EncodeStatus::ok);
  EXPECT_EQ(hex(frame), "00910100");
  OdriveHeartbeat heartbeat;
  ASSERT_EQ(decode(0, with_payload(classic_frame(1, 8), "010000000b000000"), heartbeat), DecodeStatus::ok);
  EXPECT_EQ(heartbeat.errors, 1u);
  EXPECT_EQ(heartbeat.state, 11);
}

TEST(Odrive, PositionsAndVelocitiesAreRevolutionsOnTheWire) {
  OdriveEstimates estimates;
  ASSERT_EQ(decode(2, with_payload(classic_frame(0x49, 8), "0000803f000000c0"), estimates), DecodeStatus::ok);
  EXPECT_DOUBLE_EQ(estimates.position_rad, kTurn);
  EXPECT_DOUBLE_EQ(estimates.velocity_rad_s, -2 * kTurn);
}

TEST(Odrive, EveryMessageComesBack) {
  constexpr std::uint64_t kSeed = 4301;
  SCOPED_TRACE(kSeed);
  RandomValues random(kSeed);
  for (int i = 0; i < 50'000; ++i) {
    const auto node = static_cast<std::uint8_t>(random.below(64));
    CanFrame frame;
    const OdriveEstimates estimates{random.between(-1e4, 1e4), random.between(-1e3, 1e3)};
    ASSERT_EQ(encode(node, estimates, frame), EncodeStatus::ok);
    OdriveEstimates estimates_back;
    ASSERT_EQ(decode(node, frame, estimates_back), DecodeStatus::ok);
    ASSERT_NEAR(estimates_back.position_rad, estimates.position_rad, 1e-7 * 1e4);
    ASSERT_NEAR(estimates_back.velocity_rad_s, estimates.velocity_rad_s, 1e-7 * 1e3);

    const OdriveTorques torques{random.between(-300, 300), random.between(-300, 300)};
    ASSERT_EQ(encode(node, torques, frame), EncodeStatus::ok);
    OdriveTorques torques_back;
    ASSERT_EQ(decode(node, frame, torques_back), DecodeStatus::ok);
    ASSERT_EQ(torques_back.estimate_Nm, static_cast<float>(torques.estimate_Nm));

    const OdriveHeartbeat heartbeat{random.below(0xffffffff), static_cast<std::uint8_t>(random.below(15)),
                                    static_cast<std::uint8_t>(random.below(20)), random.chance(0.5)};
    ASSERT_EQ(encode(node, heartbeat, frame), EncodeStatus::ok);
    OdriveHeartbeat heartbeat_back;
    ASSERT_EQ(decode(node, frame, heartbeat_back), DecodeStatus::ok);
    ASSERT_EQ(heartbeat_back, heartbeat);

    const OdriveErrors errors{random.below(0xffffffff), random.below(0xffffffff)};
    ASSERT_EQ(encode(node, errors, frame), EncodeStatus::ok);
    OdriveErrors errors_back;
    ASSERT_EQ(decode(node, frame, errors_back), DecodeStatus::ok);
    ASSERT_EQ(errors_back, errors);

    const double torque_Nm = random.between(-300, 300);
    ASSERT_EQ(encode_input_torque(node, torque_Nm, frame), EncodeStatus::ok);
    double torque_back_Nm = 0;
    ASSERT_EQ(decode_input_torque(node, frame, torque_back_Nm), DecodeStatus::ok);
    ASSERT_EQ(torque_back_Nm, static_cast<float>(torque_Nm));

    const OdriveInputPosition input{random.between(-100, 100), random.between(-200, 200),
                                    random.between(-32, 32)};
    ASSERT_EQ(encode_input_position(node, input.position_rad, input.velocity_rad_s, input.torque_Nm, frame),
              EncodeStatus::ok);
    OdriveInputPosition input_back;
    ASSERT_EQ(decode_input_position(node, frame, input_back), DecodeStatus::ok);
    ASSERT_NEAR(input_back.position_rad, input.position_rad, 1e-5);
    ASSERT_NEAR(input_back.velocity_rad_s, input.velocity_rad_s, 0.5001e-3 * kTurn);
    ASSERT_NEAR(input_back.torque_Nm, input.torque_Nm, 0.5001e-3);

    const std::uint8_t bytes = std::array<std::uint8_t, 4>{0, 1, 2, 4}[random.below(4)];
    const std::uint32_t mask = bytes == 4 ? 0xffffffff : (1u << (8 * bytes)) - 1;
    const OdriveParameter parameter{false, static_cast<std::uint16_t>(random.below(0x10000)),
                                    random.below(0xffffffff) & mask, bytes};
    ASSERT_EQ(encode_parameter_answer(node, parameter, frame), EncodeStatus::ok);
    OdriveParameter parameter_back;
    ASSERT_EQ(decode_parameter_answer(node, frame, parameter_back), DecodeStatus::ok);
    ASSERT_EQ(parameter_back.endpoint, parameter.endpoint);
    ASSERT_EQ(parameter_back.bits, parameter.bits);
  }
}

TEST(Odrive, VersionTemperatureAndSupplyComeBack) {
  CanFrame frame;
  const OdriveVersion version{2, 4, 4, 58, 0, 6, 11, 0};
  ASSERT_EQ(encode(7, version, frame), EncodeStatus::ok);
  OdriveVersion version_back;
  ASSERT_EQ(decode(7, frame, version_back), DecodeStatus::ok);
  EXPECT_EQ(version_back, version);
  ASSERT_EQ(encode(7, OdriveTemperatures{40, kNaN}, frame), EncodeStatus::ok);
  OdriveTemperatures temperatures;
  ASSERT_EQ(decode(7, frame, temperatures), DecodeStatus::ok);
  EXPECT_EQ(temperatures.driver_C, 40);
  EXPECT_TRUE(std::isnan(temperatures.motor_C)) << "a motor without a sensor";
  ASSERT_EQ(encode(7, OdriveSupply{24, -1.5}, frame), EncodeStatus::ok);
  OdriveSupply supply;
  ASSERT_EQ(decode(7, frame, supply), DecodeStatus::ok);
  EXPECT_EQ(supply.current_A, -1.5);
}

TEST(Odrive, ValuesBeyondTheRangeStopAtItsEnd) {
  CanFrame frame;
  EXPECT_EQ(encode_input_position(0, 0, 1e6, -1e6, frame), EncodeStatus::saturated);
  OdriveInputPosition input;
  ASSERT_EQ(decode_input_position(0, frame, input), DecodeStatus::ok);
  EXPECT_NEAR(input.velocity_rad_s, 32.767 * kTurn, 1e-9);
  EXPECT_NEAR(input.torque_Nm, -32.768, 1e-12);
  EXPECT_EQ(encode_input_torque(0, 1e300, frame), EncodeStatus::saturated);
}

TEST(Odrive, WhatIsNotFiniteIsNeitherSentNorAccepted) {
  CanFrame frame;
  EXPECT_EQ(encode_input_torque(0, kNaN, frame), EncodeStatus::not_finite);
  EXPECT_EQ(encode_input_position(0, 0, kNaN, 0, frame), EncodeStatus::not_finite);
  OdriveEstimates estimates{1, 2};
  EXPECT_EQ(decode(0, with_payload(classic_frame(9, 8), "0000c07f00000000"), estimates),
            DecodeStatus::not_finite);
  EXPECT_EQ(decode(0, with_payload(classic_frame(9, 8), "000000000000807f"), estimates),
            DecodeStatus::not_finite);
  EXPECT_EQ(estimates.position_rad, 1) << "the output stays as it was";
}

TEST(Odrive, MessagesThatDoNotFitAreNamed) {
  OdriveEstimates estimates;
  const CanFrame good = with_payload(classic_frame(9, 8), "0000803f00000000");
  for (std::uint8_t length = 0; length < 8; ++length) {
    CanFrame frame = good;
    frame.length = length;
    EXPECT_EQ(decode(0, frame, estimates), DecodeStatus::wrong_length);
  }
  EXPECT_EQ(decode(1, good, estimates), DecodeStatus::not_addressed);
  for (bool CanFrame::* flag : {&CanFrame::extended, &CanFrame::remote, &CanFrame::error, &CanFrame::fd}) {
    CanFrame frame = good;
    frame.*flag = true;
    EXPECT_EQ(decode(0, frame, estimates), DecodeStatus::not_addressed);
  }
  OdriveParameter parameter;
  EXPECT_EQ(decode_parameter_request(0, with_payload(classic_frame(4, 8), "02910100"), parameter),
            DecodeStatus::malformed);
  EXPECT_EQ(decode_parameter_answer(0, with_payload(classic_frame(5, 8), "000000"), parameter),
            DecodeStatus::wrong_length);
}

TEST(Odrive, AnExpiredWatchdogIsLostCommunication) {
  EXPECT_EQ(odrive_fault(0), DriverFault::none);
  EXPECT_EQ(odrive_fault(0x01000000), DriverFault::lost_communication);
  EXPECT_EQ(odrive_fault(0x01000100), DriverFault::lost_communication);
  EXPECT_EQ(odrive_fault(0x02000000), DriverFault::emergency_stop);
  EXPECT_EQ(odrive_fault(0x80000000), DriverFault::other);
}

}  // namespace
}  // namespace stilt::hal::odrive
