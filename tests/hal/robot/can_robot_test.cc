#include "hal/robot/can_robot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "hal/moteus/moteus_emulator.h"
#include "tests/hal/random_values.h"
#include "tests/hal/robot/emulated_robot.h"

namespace stilt::hal {
namespace {

using mock::FrameFault;
using stilt::hal::testing::RandomValues;

using stilt::hal::testing::Kind;
using stilt::hal::testing::kind_name;
using stilt::hal::testing::kTick_ns;
using stilt::hal::testing::Robot;
using stilt::hal::testing::some_commands;

class EveryProtocol : public ::testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(CanRobot, EveryProtocol, ::testing::Values(Kind::mit, Kind::moteus, Kind::odrive),
                         kind_name);

TEST_P(EveryProtocol, ReadingsAreJointAnglesInTheConvention) {
  Robot robot(GetParam());
  for (std::size_t joint = 0; joint < kJoints; ++joint)
    robot.set_joint(joint, 0.3 + 0.1 * static_cast<double>(joint), -1.0 + 0.5 * static_cast<double>(joint));
  static_cast<void>(robot.read());
  ASSERT_EQ(robot.robot_->write(some_commands()), JointBusStatus::ok);
  robot.clock_.advance(kTick_ns);
  EXPECT_EQ(robot.read(), JointBusStatus::ok);
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    EXPECT_NEAR(robot.readings_[joint].position_rad, 0.3 + 0.1 * static_cast<double>(joint), 5e-4);
    EXPECT_NEAR(robot.readings_[joint].velocity_rad_s, -1.0 + 0.5 * static_cast<double>(joint), 0.04);
    EXPECT_EQ(robot.readings_[joint].missed_replies, 0u);
    EXPECT_EQ(robot.readings_[joint].fault, DriverFault::none);
    EXPECT_EQ(robot.readings_[joint].time_ns, robot.clock_.now_ns());
  }
}

TEST_P(EveryProtocol, TheTorqueAtTheJointFollowsTheLawOfTheCommand) {
  constexpr std::uint64_t kSeed = 4701;
  SCOPED_TRACE(kSeed);
  RandomValues random(kSeed);
  Robot robot(GetParam());
  for (int i = 0; i < 500; ++i) {
    JointCommands commands;
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      commands[joint] = {random.between(-0.1, 0.1), random.between(-1, 1), random.between(-5, 5),
                         random.between(0, 60),     random.between(0, 3),  100};
      robot.set_joint(joint, random.between(-0.1, 0.1), random.between(-1, 1));
    }
    robot.clock_.advance(kTick_ns);
    static_cast<void>(robot.read());
    static_cast<void>(robot.robot_->write(commands));  // lets MIT and moteus answer
    robot.clock_.advance(kTick_ns);
    ASSERT_EQ(robot.read(), JointBusStatus::ok);
    ASSERT_EQ(robot.robot_->write(commands), JointBusStatus::ok);
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      const JointWiring& wiring = robot.wiring_.joints[joint];
      const auto& motor = robot.drivers_[joint]->motor;
      const double q = wiring.direction * motor.position_rad / wiring.ratio + wiring.offset_rad;
      const double v = wiring.direction * motor.velocity_rad_s / wiring.ratio;
      const JointCommand& command = commands[joint];
      const double expected_Nm = command.torque_Nm + command.kp_Nm_rad * (command.position_rad - q) +
                                 command.kd_Nms_rad * (command.velocity_rad_s - v);
      ASSERT_NEAR(robot.joint_torque_Nm(joint), expected_Nm, 0.15) << "joint " << joint << ", round " << i;
    }
  }
}

TEST_P(EveryProtocol, ALostReplyIsAMissAndNothingElse) {
  Robot robot(GetParam());
  static_cast<void>(robot.read());
  robot.buses_[0].add_fault({.fault = FrameFault::lose, .id = robot.frame_ids_[1], .any_id = false});
  for (std::uint32_t miss = 1; miss <= 5; ++miss) {
    const std::uint32_t before = robot.readings_[1].missed_replies;
    static_cast<void>(robot.robot_->write(some_commands()));
    robot.clock_.advance(kTick_ns);
    EXPECT_EQ(robot.read(), JointBusStatus::incomplete);
    EXPECT_EQ(robot.readings_[1].missed_replies, before + 1);
    EXPECT_EQ(robot.readings_[0].missed_replies, 0u);
  }
}

/// An ODrive reports all the same, and goes on with its last torque until its watchdog ends it.
TEST_P(EveryProtocol, CommandsThatDoNotLeaveAreMisses) {
  Robot robot(GetParam());
  const auto tick = [&] {
    static_cast<void>(robot.robot_->write(some_commands()));
    robot.clock_.advance(kTick_ns);
    static_cast<void>(robot.read());
  };
  tick();
  robot.buses_[0].set_queue_full(true);
  for (std::uint32_t miss = 1; miss <= 5; ++miss) {
    tick();
    for (std::size_t joint = 0; joint < kJoints; ++joint)
      EXPECT_EQ(robot.readings_[joint].missed_replies, joint < 2 ? miss : 0u) << joint;
  }
  robot.buses_[0].set_queue_full(false);
  tick();
  for (const JointReading& reading : robot.readings_) EXPECT_EQ(reading.missed_replies, 0u);
}

TEST_P(EveryProtocol, LateRepliesArriveAsMissesThenAsReadings) {
  Robot robot(GetParam());
  static_cast<void>(robot.robot_->write(some_commands()));
  static_cast<void>(robot.read());
  robot.buses_[0].add_fault({.fault = FrameFault::delay, .delay_ns = 2 * kTick_ns});
  std::vector<bool> fresh;
  for (int tick = 0; tick < 6; ++tick) {
    static_cast<void>(robot.robot_->write(some_commands()));
    robot.clock_.advance(kTick_ns);
    static_cast<void>(robot.read());
    fresh.push_back(robot.readings_[0].missed_replies == 0);
  }
  EXPECT_FALSE(fresh[0]);
  EXPECT_TRUE(fresh[5]);
}

TEST_P(EveryProtocol, AFrozenEncoderShowsAsEqualBits) {
  Robot robot(GetParam());
  RandomValues random(4702);
  const auto tick = [&] {
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      robot.set_joint(joint, random.between(-1, 1), random.between(-5, 5));
    }
    static_cast<void>(robot.robot_->write(some_commands()));
    robot.clock_.advance(kTick_ns);
    static_cast<void>(robot.read());
  };
  static_cast<void>(robot.read());
  for (int i = 0; i < 20; ++i) tick();
  EXPECT_EQ(robot.readings_[2].unchanged_replies, 0u);
  robot.drivers_[2]->freeze_encoder(true);
  for (int i = 0; i < 20; ++i) tick();
  EXPECT_GE(robot.readings_[2].unchanged_replies, 18u);
  EXPECT_EQ(robot.readings_[3].unchanged_replies, 0u);
}

TEST_P(EveryProtocol, ADriverFaultIsReportedByItsName) {
  Robot robot(GetParam());
  static_cast<void>(robot.read());
  robot.drivers_[3]->raise(DriverFault::over_voltage);
  for (int tick = 0; tick < 110; ++tick) {  // an ODrive reports it with its heartbeat, every 100 ms
    static_cast<void>(robot.robot_->write(some_commands()));
    robot.clock_.advance(kTick_ns);
    static_cast<void>(robot.read());
  }
  EXPECT_EQ(robot.readings_[3].state, DriverState::fault);
  EXPECT_EQ(robot.readings_[3].fault, DriverFault::over_voltage);
  EXPECT_EQ(robot.joint_torque_Nm(3), 0);
}

TEST_P(EveryProtocol, NothingIsSentWhenACommandIsNotFinite) {
  Robot robot(GetParam());
  static_cast<void>(robot.read());
  for (double JointCommand::* field :
       {&JointCommand::position_rad, &JointCommand::velocity_rad_s, &JointCommand::torque_Nm,
        &JointCommand::kp_Nm_rad, &JointCommand::kd_Nms_rad, &JointCommand::torque_limit_Nm}) {
    JointCommands commands = some_commands();
    commands[2].*field = std::nan("");
    EXPECT_EQ(robot.robot_->write(commands), JointBusStatus::refused);
    EXPECT_TRUE(robot.buses_[0].sent().empty());
    EXPECT_TRUE(robot.buses_[1].sent().empty());
  }
}

TEST_P(EveryProtocol, DisableLetsEveryMotorGo) {
  Robot robot(GetParam());
  static_cast<void>(robot.read());
  static_cast<void>(robot.robot_->write(some_commands()));
  EXPECT_EQ(robot.robot_->disable(), JointBusStatus::ok);
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    EXPECT_FALSE(robot.drivers_[joint]->enabled());
    EXPECT_EQ(robot.joint_torque_Nm(joint), 0);
  }
}

TEST_P(EveryProtocol, ADeadBusIsNamedAndTheOtherGoesOn) {
  Robot robot(GetParam());
  static_cast<void>(robot.read());
  robot.buses_[1].set_disconnected(true);
  EXPECT_EQ(robot.robot_->write(some_commands()), JointBusStatus::disconnected);
  robot.clock_.advance(kTick_ns);
  EXPECT_EQ(robot.read(), JointBusStatus::disconnected);
  EXPECT_EQ(robot.readings_[0].missed_replies, 0u);
  EXPECT_GE(robot.readings_[2].missed_replies, 1u);
  robot.buses_[1].set_disconnected(false);
  robot.buses_[1].set_health(BusHealth::off);
  EXPECT_EQ(robot.read(), JointBusStatus::bus_off);
  robot.buses_[1].set_health(BusHealth::active);
  robot.buses_[0].set_queue_full(true);
  EXPECT_EQ(robot.robot_->write(some_commands()), JointBusStatus::incomplete);
}

TEST_P(EveryProtocol, CorruptFramesNeverGiveANumberThatIsNotFinite) {
  Robot robot(GetParam());
  static_cast<void>(robot.read());
  for (std::uint16_t bit = 0; bit < 168; ++bit) {
    robot.buses_[0].clear_faults();
    robot.buses_[0].add_fault({.fault = FrameFault::corrupt, .bit = bit});
    static_cast<void>(robot.robot_->write(some_commands()));
    robot.clock_.advance(kTick_ns);
    static_cast<void>(robot.read());
    for (const JointReading& reading : robot.readings_) {
      ASSERT_FALSE(std::isinf(reading.position_rad)) << bit;
      ASSERT_FALSE(std::isinf(reading.velocity_rad_s)) << bit;
    }
  }
}

TEST(CanRobot, RandomFramesNeverGiveAnInfiniteReading) {
  constexpr std::uint64_t kSeed = 4703;
  SCOPED_TRACE(kSeed);
  RandomValues random(kSeed);
  for (const Kind kind : {Kind::mit, Kind::moteus, Kind::odrive}) {
    Robot robot(kind);
    for (int i = 0; i < 20'000; ++i) {
      CanFrame frame = random.frame();
      if (random.chance(0.7)) {
        frame.id = robot.frame_ids_[random.below(4)];
        frame.extended = frame.error = frame.remote = false;
        frame.fd = kind == Kind::moteus;
        if (random.chance(0.8)) frame.length = kind == Kind::moteus ? 20 : 8;
      }
      robot.buses_[random.below(2)].script(frame, robot.clock_.now_ns());
      static_cast<void>(robot.read());
      for (const JointReading& reading : robot.readings_) ASSERT_FALSE(std::isinf(reading.position_rad));
    }
  }
}

/// Commands and readings for a while.
void run(Robot& robot, int ticks, const JointCommands& commands) {
  for (int tick = 0; tick < ticks; ++tick) {
    static_cast<void>(robot.robot_->write(commands));
    robot.clock_.advance(kTick_ns);
    static_cast<void>(robot.read());
  }
}

TEST(CanRobot, AnOdriveIsAskedForSupplyAndTemperatures) {
  Robot robot(Kind::odrive);
  run(robot, 110, some_commands());
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    EXPECT_EQ(robot.readings_[joint].supply_V, 24) << joint;
    EXPECT_EQ(robot.readings_[joint].motor_temperature_C, 30) << joint;
    robot.drivers_[joint]->motor.supply_V = 20.5;
  }
  run(robot, 110, some_commands());
  for (const JointReading& reading : robot.readings_) EXPECT_EQ(reading.supply_V, 20.5);
}

TEST(CanRobot, AMoteusIsAskedForTheTemperatureOfItsMotorInItsCommands) {
  Robot robot(Kind::moteus);
  run(robot, 110, some_commands());
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    EXPECT_EQ(robot.readings_[joint].motor_temperature_C, 30) << joint;
    EXPECT_EQ(robot.readings_[joint].state, DriverState::enabled) << joint;
    robot.drivers_[joint]->motor.temperature_C = 61;
  }
  run(robot, 110, some_commands());
  for (const JointReading& reading : robot.readings_) EXPECT_EQ(reading.motor_temperature_C, 61);
}

TEST(CanRobot, AnOdriveGetsNoDampingForAVelocityOfLongAgo) {
  Robot robot(Kind::odrive);
  robot.set_joint(1, 0.2, 3.0);
  JointCommands damping{};
  for (JointCommand& command : damping) command = {.torque_Nm = 1, .kd_Nms_rad = 2, .torque_limit_Nm = 50};
  run(robot, 20, damping);
  EXPECT_NEAR(robot.joint_torque_Nm(1), 1 - 2 * 3.0, 1e-3);
  robot.buses_[robot.wiring_.joints[1].bus].add_fault({.id = robot.frame_ids_[1], .any_id = false});
  run(robot, 3, damping);
  EXPECT_NEAR(robot.joint_torque_Nm(1), 1 - 2 * 3.0, 1e-3) << "a reading of a moment ago will do";
  run(robot, 10, damping);
  EXPECT_NEAR(robot.joint_torque_Nm(1), 1, 1e-3);
}

TEST(CanRobot, AMoteusCanCarryTheTorsosEncoder) {
  Robot robot(Kind::moteus);
  static_cast<moteus::MoteusEmulator&>(*robot.drivers_[0]).set_encoder(1, 0.2, -0.5);
  static_cast<void>(robot.robot_->write(some_commands()));
  robot.clock_.advance(kTick_ns);
  static_cast<void>(robot.read());
  BaseReading base;
  EXPECT_EQ(robot.robot_->read_base(base), TorsoSensorStatus::ok);
  EXPECT_NEAR(base.pitch_rad, 0.2, 1e-4);
  EXPECT_NEAR(base.pitch_rate_rad_s, -0.5, 1e-4);
}

TEST(CanRobot, AMoteusWhoseWatchdogExpiredHasLostCommunication) {
  Robot robot(Kind::moteus);
  static_cast<void>(robot.robot_->write(some_commands()));
  static_cast<void>(robot.read());
  robot.clock_.advance(50 * kTick_ns);
  static_cast<void>(robot.read());
  static_cast<void>(robot.robot_->write(some_commands()));
  robot.clock_.advance(kTick_ns);
  static_cast<void>(robot.read());
  EXPECT_EQ(robot.readings_[0].fault, DriverFault::lost_communication);
  EXPECT_EQ(robot.readings_[0].state, DriverState::fault);
}

TEST(CanRobot, ATorqueIsNotComputedFromAReadingThatNeverCame) {
  Robot robot(Kind::odrive);
  const std::array<FrameBus*, 2> buses{&robot.buses_[0], &robot.buses_[1]};
  CanRobot deaf(robot.wiring_, buses);
  EXPECT_EQ(deaf.write(some_commands()), JointBusStatus::incomplete);
  for (std::size_t joint = 0; joint < kJoints; ++joint) EXPECT_EQ(robot.joint_torque_Nm(joint), 0);
}

TEST(CanRobot, WiringWithoutSenseIsRefused) {
  const RobotWiring good = Robot(Kind::moteus).wiring_;
  EXPECT_TRUE(valid(good, 2));
  EXPECT_FALSE(valid(good, 1)) << "a joint on a bus that does not exist";
  RobotWiring wiring = good;
  wiring.joints[1].driver = wiring.joints[0].driver;
  EXPECT_FALSE(valid(wiring, 2)) << "two joints, one driver";
  wiring = good;
  wiring.joints[0].direction = 0.5;
  EXPECT_FALSE(valid(wiring, 2));
  wiring = good;
  wiring.pitch_encoder_joint = 1;
  EXPECT_FALSE(valid(wiring, 2)) << "that driver reports no extra encoder";
}

}  // namespace
}  // namespace stilt::hal
