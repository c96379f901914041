#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hal/robot/can_robot.h"
#include "tests/hal/hex.h"
#include "tests/hal/robot/emulated_robot.h"

// Units, signs and states of what CanRobot reads, and limits of what it commands.
namespace stilt::hal {
namespace {

using mock::FrameFault;
using stilt::hal::testing::Kind;
using stilt::hal::testing::kind_name;
using stilt::hal::testing::kTick_ns;
using stilt::hal::testing::Robot;
using stilt::hal::testing::some_commands;

class CanRobotReading : public ::testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(EveryProtocol, CanRobotReading,
                         ::testing::Values(Kind::mit, Kind::moteus, Kind::odrive), kind_name);

void tick(Robot& robot, const JointCommands& commands) {
  ASSERT_EQ(robot.robot_->write(commands), JointBusStatus::ok);
  robot.clock_.advance(kTick_ns);
  static_cast<void>(robot.read());
}

TEST(CanRobot, ATorqueCommandedAtTheJointIsTheTorqueReadAtTheJoint) {
  for (const Kind kind : {Kind::mit, Kind::moteus}) {
    Robot robot(kind);
    JointCommands commands{};
    for (std::size_t joint = 0; joint < kJoints; ++joint)
      commands[joint] = {.torque_Nm = 4.0 + static_cast<double>(joint), .torque_limit_Nm = 50};
    tick(robot, commands);
    tick(robot, commands);  // a moteus answers from the state before the command
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      EXPECT_NEAR(robot.readings_[joint].torque_Nm, commands[joint].torque_Nm, 0.05) << joint;
      EXPECT_NEAR(robot.joint_torque_Nm(joint), commands[joint].torque_Nm, 0.05) << joint;
    }
  }
}

TEST(CanRobot, AnOdrivesTorqueEstimateIsReadAtTheJoint) {
  Robot robot(Kind::odrive);
  CanFrame frame;
  ASSERT_EQ(odrive::encode(2, odrive::OdriveTorques{3, 0.5}, frame), EncodeStatus::ok);
  robot.buses_[0].script(frame, robot.clock_.now_ns());
  robot.buses_[1].script(frame, robot.clock_.now_ns());
  static_cast<void>(robot.read());
  EXPECT_DOUBLE_EQ(robot.readings_[1].torque_Nm, -8 * 0.5) << "direction -1, ratio 8";
  EXPECT_DOUBLE_EQ(robot.readings_[3].torque_Nm, -8 * 0.8 * 0.5) << "torque factor 0.8";
  EXPECT_TRUE(std::isnan(robot.readings_[0].torque_Nm)) << "another node";
}

/// What torque_mismatch compares: with an ODrive, too.
TEST(CanRobot, AnOdriveThatGivesNoTorqueReportsThatWithinFiveTicks) {
  Robot robot(Kind::odrive);
  JointCommands commands{};
  commands.fill({.torque_Nm = 30, .torque_limit_Nm = 50});
  for (int i = 0; i < 6; ++i) tick(robot, commands);
  for (const JointReading& joint : robot.readings_) EXPECT_NEAR(joint.torque_Nm, 30, 1e-4);
  robot.drivers_[2]->lose_torque(true);
  for (int i = 0; i < 6; ++i) tick(robot, commands);
  EXPECT_EQ(robot.readings_[2].torque_Nm, 0);
  EXPECT_NEAR(robot.readings_[3].torque_Nm, 30, 1e-4);
}

TEST_P(CanRobotReading, TheTurnFoundAtBringUpCountsInReadingsAndCommands) {
  Robot robot(GetParam());
  const hal::JointValues shaft_turns_rad{0, 2 * std::numbers::pi, -4, 3};
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    robot.robot_->set_turn_offset(joint, shaft_turns_rad[joint]);
    robot.set_joint(joint, 0.3, 0);
  }
  tick(robot, some_commands());
  JointCommands commands{};
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    const JointWiring& wiring = robot.wiring_.joints[joint];
    const double true_rad = 0.3 + wiring.direction * shaft_turns_rad[joint] / wiring.ratio;
    EXPECT_NEAR(robot.readings_[joint].position_rad, true_rad, 5e-4) << joint;
    commands[joint] = {.position_rad = true_rad + 0.05, .kp_Nm_rad = 60, .torque_limit_Nm = 50};
  }
  tick(robot, commands);
  for (std::size_t joint = 0; joint < kJoints; ++joint)
    EXPECT_NEAR(robot.joint_torque_Nm(joint), 60 * 0.05, 0.1) << joint;
}

TEST_P(CanRobotReading, OnlyEqualPositionWithEqualVelocityIsARepetition) {
  Robot robot(GetParam());
  const auto frozen_at = [&robot](double position_rad, double velocity_rad_s) {
    robot.set_joint(2, position_rad, velocity_rad_s);
    tick(robot, some_commands());
    return robot.readings_[2].unchanged_replies;
  };
  EXPECT_EQ(frozen_at(0.3, 1), 0u);
  EXPECT_EQ(frozen_at(0.3, 1), 1u);
  EXPECT_EQ(frozen_at(0.3, 1), 2u);
  EXPECT_EQ(frozen_at(0.3, 5), 0u) << "another velocity";
  EXPECT_EQ(frozen_at(0.6, 5), 0u) << "another position";
}

TEST_P(CanRobotReading, TheStateOfADriverIsThatOfItsMotor) {
  Robot robot(GetParam());
  for (int i = 0; i < 110; ++i) tick(robot, some_commands());  // ODrive: state with its heartbeat
  for (const JointReading& reading : robot.readings_) {
    EXPECT_EQ(reading.state, DriverState::enabled);
    EXPECT_EQ(reading.driver_temperature_C, 30);
    EXPECT_EQ(reading.malformed, 0u);
  }
  for (int i = 0; i < 110; ++i) {
    ASSERT_EQ(robot.robot_->disable(), JointBusStatus::ok);
    robot.clock_.advance(kTick_ns);
    static_cast<void>(robot.read());
  }
  for (const JointReading& reading : robot.readings_) EXPECT_EQ(reading.state, DriverState::idle);
}

TEST_P(CanRobotReading, FramesOfTheWrongLengthCountAtTheirJointAndChangeNothing) {
  Robot robot(GetParam());
  tick(robot, some_commands());
  const JointReading before = robot.readings_[3];
  CanFrame frame = classic_frame(robot.frame_ids_[3], 5);
  frame.data.fill(0x20);  // of the driver; as moteus: a reply that is cut off
  if (GetParam() == Kind::mit) frame.data[0] = 0x12;
  robot.buses_[1].script(frame, robot.clock_.now_ns());
  static_cast<void>(robot.read());
  EXPECT_EQ(robot.readings_[3].malformed, 1u);
  EXPECT_EQ(robot.readings_[3].position_rad, before.position_rad);
  EXPECT_EQ(robot.readings_[3].time_ns, before.time_ns);
  EXPECT_EQ(robot.readings_[2].malformed, 0u);
}

/// What finds an adapter that begins to hold replies up: supervisor.missed_hold_ticks, missed_damp_ticks.
TEST_P(CanRobotReading, ALagThatBeginsShowsAsMissedReadsOfItsLength) {
  for (const std::uint32_t lag : {2U, 3U, 10U, 15U}) {
    Robot robot(GetParam());
    for (int i = 0; i < 20; ++i) tick(robot, some_commands());
    for (auto& bus : robot.buses_) bus.add_fault({.fault = FrameFault::delay, .delay_ns = lag * kTick_ns});
    std::uint32_t most_missed = 0;
    for (int i = 0; i < 40; ++i) {
      tick(robot, some_commands());
      for (const JointReading& joint : robot.readings_)
        most_missed = std::max(most_missed, joint.missed_replies);
    }
    EXPECT_GE(most_missed, lag - 1) << "a reply had a tick to arrive in";
    EXPECT_LE(most_missed, lag);
    EXPECT_EQ(robot.readings_[0].missed_replies, 0u) << "and then none, however old they are";
  }
}

TEST(CanRobot, DriversThatTakeALimitGetItAtTheirShaft) {
  for (const Kind kind : {Kind::moteus, Kind::odrive}) {
    Robot robot(kind);
    JointCommands commands{};
    commands.fill({.position_rad = 10, .kp_Nm_rad = 100, .torque_limit_Nm = 7});
    tick(robot, commands);
    for (std::size_t joint = 0; joint < kJoints; ++joint)
      EXPECT_NEAR(robot.joint_torque_Nm(joint), 7, 0.02) << joint;
    commands.fill({.torque_Nm = -30, .torque_limit_Nm = -7});
    tick(robot, commands);
    for (std::size_t joint = 0; joint < kJoints; ++joint)
      EXPECT_NEAR(robot.joint_torque_Nm(joint), -7, 0.02) << "the sign of a limit means nothing";
  }
}

TEST(CanRobot, AMoteusWithoutAPositionIsMissed) {
  Robot robot(Kind::moteus);
  tick(robot, some_commands());
  const JointReading before = robot.readings_[1];
  CanFrame unknown;
  unknown.id = robot.frame_ids_[1];
  unknown.fd = true;
  unknown = testing::with_payload(unknown, "290100000080");  // position: the integer for "not known"
  robot.clock_.advance(kTick_ns);
  robot.buses_[0].script(unknown, robot.clock_.now_ns());
  EXPECT_EQ(robot.read(), JointBusStatus::incomplete);
  EXPECT_EQ(robot.readings_[1].missed_replies, before.missed_replies + 1);
  EXPECT_EQ(robot.readings_[1].position_rad, before.position_rad);
}

TEST(CanRobot, AMoteusInFaultModeHasAFaultWhateverItsCode) {
  Robot robot(Kind::moteus);
  CanFrame frame;
  frame.id = robot.frame_ids_[1];
  frame.fd = true;
  frame = testing::with_payload(frame, "210001210f00");  // mode fault, code 0
  robot.buses_[0].script(frame, robot.clock_.now_ns());
  static_cast<void>(robot.read());
  EXPECT_EQ(robot.readings_[1].state, DriverState::fault);
  EXPECT_EQ(robot.readings_[1].fault, DriverFault::other);
}

TEST(CanRobot, EveryChannelOfTheTorsoSensorHasItsOwnPlace) {
  Robot robot(Kind::mit);
  const std::array<BaseChannel, 6> channels{
      BaseChannel::pitch_rad,           BaseChannel::pitch_rate_rad_s,  BaseChannel::acceleration_x_m_s2,
      BaseChannel::acceleration_z_m_s2, BaseChannel::left_foot_force_N, BaseChannel::right_foot_force_N};
  CanFrame frame = classic_frame(0x60, 8);
  for (std::size_t i = 0; i < channels.size(); ++i) {
    robot.wiring_.channels[i] = {.id = 0x60, .byte_offset = static_cast<std::uint8_t>(i), .bits = 8};
    robot.wiring_.channels[i].channel = channels[i];
    frame.data[i] = static_cast<std::uint8_t>(11 + i);
  }
  robot.wiring_.channel_count = channels.size();
  const std::array<FrameBus*, 2> buses{&robot.buses_[0], &robot.buses_[1]};
  CanRobot sensing(robot.wiring_, buses);
  EXPECT_EQ(sensing.read_emergency_stop(robot.clock_.now_ns()), EmergencyStopState::absent);
  robot.buses_[0].script(frame, robot.clock_.now_ns());
  static_cast<void>(sensing.read(robot.clock_.now_ns(), robot.readings_));
  BaseReading base;
  ASSERT_EQ(sensing.read_base(base), TorsoSensorStatus::ok);
  EXPECT_EQ(base.pitch_rad, 11);
  EXPECT_EQ(base.pitch_rate_rad_s, 12);
  EXPECT_EQ(base.acceleration_x_m_s2, 13);
  EXPECT_EQ(base.acceleration_z_m_s2, 14);
  EXPECT_EQ(base.left_foot_force_N, 15);
  EXPECT_EQ(base.right_foot_force_N, 16);
  EXPECT_EQ(base.time_ns, robot.clock_.now_ns());
  EXPECT_EQ(base.malformed, 0u);
  frame.length = 4;
  robot.buses_[0].script(frame, robot.clock_.now_ns());
  static_cast<void>(sensing.read(robot.clock_.now_ns(), robot.readings_));
  EXPECT_EQ(sensing.read_base(base), TorsoSensorStatus::stale);
  EXPECT_EQ(base.malformed, 1u) << "cut off";
  EXPECT_EQ(base.pitch_rad, 11);
}

TEST(CanRobot, AnEmergencyStopCountsUpToItsTimeoutAndNotAfter) {
  Robot robot(Kind::mit);
  EXPECT_EQ(robot.robot_->read_emergency_stop(kTick_ns), EmergencyStopState::unknown)
      << "a clock that has just started, as in lockstep";
  CanFrame frame = classic_frame(0x50, 4);
  frame.data[2] = 1;
  robot.buses_[0].script(frame, robot.clock_.now_ns());
  static_cast<void>(robot.read());
  const std::int64_t end_ns = robot.clock_.now_ns() + robot.wiring_.emergency_stop_timeout_ns;
  EXPECT_EQ(robot.robot_->read_emergency_stop(end_ns), EmergencyStopState::released);
  EXPECT_EQ(robot.robot_->read_emergency_stop(end_ns + 1), EmergencyStopState::unknown);
}

TEST(CanRobot, ThePitchOfATorsoEncoderHasItsDirectionAndOffset) {
  Robot robot(Kind::moteus);
  robot.wiring_.channel_period_ticks = 3;  // means channels, not the encoder
  robot.wiring_.pitch_direction = -1;
  robot.wiring_.pitch_offset_rad = 0.5;
  const std::array<FrameBus*, 2> buses{&robot.buses_[0], &robot.buses_[1]};
  CanRobot leaning(robot.wiring_, buses);
  static_cast<moteus::MoteusEmulator&>(*robot.drivers_[0]).set_encoder(1, 0.2, -0.5);
  ASSERT_EQ(leaning.write(some_commands()), JointBusStatus::ok);
  robot.clock_.advance(kTick_ns);
  static_cast<void>(leaning.read(robot.clock_.now_ns(), robot.readings_));
  BaseReading base;
  ASSERT_EQ(leaning.read_base(base), TorsoSensorStatus::ok);
  EXPECT_NEAR(base.pitch_rad, 0.3, 1e-4);
  EXPECT_NEAR(base.pitch_rate_rad_s, 0.5, 1e-4);
  static_cast<void>(leaning.read(robot.clock_.now_ns(), robot.readings_));
  static_cast<void>(leaning.read_base(base));
  EXPECT_EQ(base.missed_replies, 1u) << "due with every read";
}

/// Registers of the encoders are within one turn: mjbots/moteus, docs/protocol/registers.md, 0x050.
TEST(CanRobot, ThePitchOfATorsoEncoderGoesOnThroughTheEndOfItsTurn) {
  Robot robot(Kind::moteus);
  const std::array<FrameBus*, 2> buses{&robot.buses_[0], &robot.buses_[1]};
  for (const double direction : {1.0, -1.0}) {
    robot.wiring_.pitch_direction = direction;
    CanRobot leaning(robot.wiring_, buses);
    for (const double angle_rad : {0.003, -0.003, -0.2, -2.0, -4.0, -6.5, -4.0, -2.0, 0.0, 1.0}) {
      const double turn_rad = 2 * std::numbers::pi;
      const double within_turn_rad = angle_rad - turn_rad * std::floor(angle_rad / turn_rad);
      robot.drivers_[0]->set_encoder(1, within_turn_rad, 0);
      ASSERT_EQ(leaning.write(some_commands()), JointBusStatus::ok);
      robot.clock_.advance(kTick_ns);
      static_cast<void>(leaning.read(robot.clock_.now_ns(), robot.readings_));
      BaseReading base;
      ASSERT_EQ(leaning.read_base(base), TorsoSensorStatus::ok);
      EXPECT_NEAR(base.pitch_rad, direction * angle_rad, 1e-4);
    }
  }
}

TEST(CanRobot, ARegisterAnswerOfADamiaoIsNoPosition) {
  Robot robot(Kind::mit);
  tick(robot, some_commands());
  const double before_rad = robot.readings_[0].position_rad;
  const auto& driver = std::get<mit::MitDriver>(robot.wiring_.joints[0].driver);
  CanFrame answer;
  ASSERT_EQ(encode_register_answer(driver, {.number = 9, .bits = 400}, answer), EncodeStatus::ok);
  robot.buses_[0].script(answer, robot.clock_.now_ns());
  static_cast<void>(robot.read());
  EXPECT_EQ(robot.readings_[0].position_rad, before_rad);
  EXPECT_EQ(robot.readings_[0].malformed, 0u);
}

TEST(CanRobot, NotANumberFromAnOdriveIsNoNewsAndNoMalformedFrame) {
  Robot robot(Kind::odrive);
  tick(robot, some_commands());
  const double before_rad = robot.readings_[0].position_rad;
  const std::uint8_t node = std::get<odrive::OdriveDriver>(robot.wiring_.joints[0].driver).node;
  for (const auto command : {odrive::OdriveCommand::encoder_estimates, odrive::OdriveCommand::torques}) {
    CanFrame frame = classic_frame(node * 32u + static_cast<std::uint32_t>(command), 8);
    frame.data = {0, 0, 0xc0, 0x7f, 0, 0, 0xc0, 0x7f};  // NaN, NaN
    robot.buses_[0].script(frame, robot.clock_.now_ns());
  }
  static_cast<void>(robot.read());
  EXPECT_EQ(robot.readings_[0].malformed, 0u);
  EXPECT_EQ(robot.readings_[0].position_rad, before_rad);
}

/// Frames of no joint, without end.
class BabblingBus final : public FrameBus {
 public:
  [[nodiscard]] SendResult send(std::span<const CanFrame> frames) noexcept override {
    return {frames.size()};
  }
  [[nodiscard]] ReceiveResult receive(std::span<CanFrame> frames) noexcept override {
    for (CanFrame& frame : frames) frame = classic_frame(0x7aa, 8);
    if (++batches_ == 1000) return {0, BusStatus::ok};  // ends a read without a bound, too
    return {frames.size(), BusStatus::more};
  }
  [[nodiscard]] BusHealth health() const noexcept override { return BusHealth::active; }
  void clear_bus_off() noexcept override {}
  [[nodiscard]] const BusCounters& counters() const noexcept override { return counters_; }
  [[nodiscard]] int batches() const noexcept { return batches_; }

 private:
  int batches_ = 0;
  BusCounters counters_;
};

TEST(CanRobot, ABabblingBusTakesABoundedShareOfARead) {
  Robot robot(Kind::mit);
  BabblingBus babbling;
  const std::array<FrameBus*, 2> buses{&babbling, &robot.buses_[1]};
  CanRobot disturbed(robot.wiring_, buses);
  ASSERT_EQ(disturbed.write(some_commands()), JointBusStatus::ok);
  robot.clock_.advance(kTick_ns);
  EXPECT_EQ(disturbed.read(robot.clock_.now_ns(), robot.readings_), JointBusStatus::incomplete);
  EXPECT_EQ(babbling.batches(), 8);
  EXPECT_EQ(robot.readings_[2].missed_replies, 0u) << "the other bus is read";
}

TEST(CanRobot, RepliesBehindManyOtherFramesAreReadInTheSameTick) {
  Robot robot(Kind::mit);
  for (std::size_t i = 0; i < 3 * kMaximumBatch; ++i)
    robot.buses_[0].script(classic_frame(0x7aa, 8), robot.clock_.now_ns());
  tick(robot, some_commands());
  EXPECT_EQ(robot.readings_[0].missed_replies, 0u);
}

}  // namespace
}  // namespace stilt::hal
