#include "hal/can_robot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "hal/bring_up/mit_bring_up.h"
#include "hal/bring_up/moteus_bring_up.h"
#include "hal/bring_up/odrive_bring_up.h"
#include "hal/mock/mit_emulator.h"
#include "hal/mock/mock_bus.h"
#include "hal/mock/moteus_emulator.h"
#include "hal/mock/odrive_emulator.h"
#include "tests/hal/random_values.h"

namespace stilt::hal {
namespace {

using mock::FrameFault;
using stilt::hal::testing::RandomValues;

constexpr std::int64_t kTick_ns = 1'000'000;

enum class Kind { mit, moteus, odrive };

/// Two buses, one a leg, with four emulated drivers of one kind and a base sensor on the first bus.
class Robot {
 public:
  explicit Robot(Kind kind) {
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      JointWiring& wiring = wiring_.joints[joint];
      wiring.bus = static_cast<std::uint8_t>(joint / 2);
      wiring.direction = joint % 2 == 0 ? 1 : -1;
      wiring.ratio = kind == Kind::odrive ? 8 : 1;
      wiring.offset_rad = 0.25;
      const auto number = static_cast<std::uint8_t>(1 + joint % 2);
      if (kind == Kind::mit) {
        protocol::MitDriver driver;
        driver.command_id = number;
        driver.reply_id = static_cast<std::uint16_t>(0x10 + number);
        driver.driver_id = number;
        driver.layout = protocol::ReplyLayout::damiao;
        wiring.driver = driver;
        drivers_[joint] = std::make_shared<mock::MitEmulator>(driver);
        frame_ids_[joint] = driver.reply_id;
      } else if (kind == Kind::moteus) {
        protocol::MoteusDriver driver;
        driver.id = number;
        driver.kp_Nm_rev = 2000;
        driver.kd_Nm_s_rev = 60;
        if (joint == 0) driver.extra_encoder = 1;
        wiring.driver = driver;
        drivers_[joint] = std::make_shared<mock::MoteusEmulator>(driver);
        frame_ids_[joint] = static_cast<std::uint32_t>(number) << 8;
      } else {
        wiring.driver = OdriveNode{number};
        drivers_[joint] = std::make_shared<mock::OdriveEmulator>(number, kEndpoints);
        frame_ids_[joint] = static_cast<std::uint32_t>(number) << 5 | 9;
      }
      buses_[wiring.bus].attach(*drivers_[joint]);
    }
    if (kind == Kind::moteus) wiring_.pitch_encoder_joint = 0;
    wiring_.channels[0] = {.id = 0x50, .scale = 1e-3, .channel = protocol::BaseChannel::pitch_rad};
    wiring_.channels[1] = {
        .id = 0x50, .byte_offset = 2, .channel = protocol::BaseChannel::emergency_stop_released};
    wiring_.channel_count = 2;
    EXPECT_TRUE(valid(wiring_, 2));
    const std::array<FrameBus*, 2> buses{&buses_[0], &buses_[1]};
    robot_ = std::make_unique<CanRobot>(wiring_, buses);
    enable();
    clock_.advance(kTick_ns);
    static_cast<void>(read());
  }

  JointBusStatus read() { return robot_->read(clock_.now_ns(), readings_); }

  /// Brings every driver up, as the controller does.
  void enable() {
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      const JointWiring& wiring = wiring_.joints[joint];
      if (const auto* mit = std::get_if<protocol::MitDriver>(&wiring.driver)) {
        bring_up::MitBringUp up(*mit, {});
        run(up, wiring.bus);
      } else if (const auto* moteus = std::get_if<protocol::MoteusDriver>(&wiring.driver)) {
        bring_up::MoteusBringUp up(*moteus, {});
        run(up, wiring.bus);
      } else {
        bring_up::OdriveBringUp up(std::get<OdriveNode>(wiring.driver).node, kEndpoints, {});
        run(up, wiring.bus);
      }
    }
    for (auto& bus : buses_) bus.clear_sent();
  }

  void set_joint(std::size_t joint, double position_rad, double velocity_rad_s) {
    const JointWiring& wiring = wiring_.joints[joint];
    drivers_[joint]->motor.position_rad =
        wiring.direction * wiring.ratio * (position_rad - wiring.offset_rad);
    drivers_[joint]->motor.velocity_rad_s = wiring.direction * wiring.ratio * velocity_rad_s;
  }
  double joint_torque_Nm(std::size_t joint) const {
    return wiring_.joints[joint].direction * wiring_.joints[joint].ratio * drivers_[joint]->torque_Nm();
  }

  static constexpr bring_up::OdriveEndpoints kEndpoints{0x191, 0x192};
  mock::MockClock clock_;
  std::array<mock::MockBus, 2> buses_{mock::MockBus(clock_), mock::MockBus(clock_)};
  RobotWiring wiring_;
  std::array<std::shared_ptr<mock::EmulatedDriver>, kJoints> drivers_;
  std::array<std::uint32_t, kJoints> frame_ids_{};
  std::unique_ptr<CanRobot> robot_;
  JointReadings readings_;

 private:
  /// Time stands still meanwhile: no driver's watchdog expires while the others are brought up.
  void run(bring_up::BringUp& up, std::size_t bus) {
    std::array<CanFrame, kMaximumBatch> received;
    for (int tick = 0; tick < 1000 && up.stage() != bring_up::Stage::ready; ++tick) {
      const std::size_t count = buses_[bus].receive(received).received;
      const bring_up::StepResult result = up.step(clock_.now_ns(), std::span(received).first(count));
      if (result.send) {
        EXPECT_EQ(buses_[bus].send(std::span(&result.frame, 1)).sent, 1u);
      }
    }
    EXPECT_EQ(up.stage(), bring_up::Stage::ready);
  }
};

JointCommands some_commands() {
  JointCommands commands;
  commands.fill({.position_rad = 0.4, .kp_Nm_rad = 100, .kd_Nms_rad = 2, .torque_limit_Nm = 50});
  return commands;
}

class EveryProtocol : public ::testing::TestWithParam<Kind> {};
std::string kind_name(const ::testing::TestParamInfo<Kind>& parameter) {
  switch (parameter.param) {
    case Kind::mit:
      return "Mit";
    case Kind::moteus:
      return "Moteus";
    case Kind::odrive:
      return "Odrive";
  }
  return "Unknown";
}
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
    EXPECT_EQ(robot.readings_[joint].missed, 0u);
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
    const std::uint32_t before = robot.readings_[1].missed;
    static_cast<void>(robot.robot_->write(some_commands()));
    robot.clock_.advance(kTick_ns);
    EXPECT_EQ(robot.read(), JointBusStatus::incomplete);
    EXPECT_EQ(robot.readings_[1].missed, before + 1);
    EXPECT_EQ(robot.readings_[0].missed, 0u);
  }
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
    fresh.push_back(robot.readings_[0].missed == 0);
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
  EXPECT_EQ(robot.readings_[2].frozen, 0u);
  robot.drivers_[2]->freeze_encoder(true);
  for (int i = 0; i < 20; ++i) tick();
  EXPECT_GE(robot.readings_[2].frozen, 18u);
  EXPECT_EQ(robot.readings_[3].frozen, 0u);
}

TEST_P(EveryProtocol, ADriverFaultIsReportedByItsName) {
  Robot robot(GetParam());
  static_cast<void>(robot.read());
  robot.drivers_[3]->raise(DriverFault::over_voltage);
  for (int tick = 0; tick < 110; ++tick) {  // ODrive tells with its heartbeat, every 100 ms
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
  JointCommands commands = some_commands();
  commands[2].torque_Nm = std::nan("");
  EXPECT_EQ(robot.robot_->write(commands), JointBusStatus::refused);
  EXPECT_TRUE(robot.buses_[0].sent().empty());
  EXPECT_TRUE(robot.buses_[1].sent().empty());
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
  EXPECT_EQ(robot.readings_[0].missed, 0u);
  EXPECT_GE(robot.readings_[2].missed, 1u);
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

TEST(CanRobot, TheBaseSensorAndTheEmergencyStopComeFromTheTable) {
  Robot robot(Kind::mit);
  BaseReading base;
  EXPECT_EQ(robot.robot_->read_base(base), BaseSensorStatus::stale);
  EXPECT_EQ(robot.robot_->read_emergency_stop(robot.clock_.now_ns()), EmergencyStopState::unknown);
  CanFrame frame = classic_frame(0x50, 4);
  frame.data = {0x64, 0x00, 0x01, 0x00};
  robot.buses_[0].script(frame, robot.clock_.now_ns());
  static_cast<void>(robot.read());
  EXPECT_EQ(robot.robot_->read_base(base), BaseSensorStatus::ok);
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

TEST(CanRobot, AMoteusCanCarryTheTorsosEncoder) {
  Robot robot(Kind::moteus);
  static_cast<mock::MoteusEmulator&>(*robot.drivers_[0]).set_encoder(1, 0.2, -0.5);
  static_cast<void>(robot.robot_->write(some_commands()));
  robot.clock_.advance(kTick_ns);
  static_cast<void>(robot.read());
  BaseReading base;
  EXPECT_EQ(robot.robot_->read_base(base), BaseSensorStatus::ok);
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
