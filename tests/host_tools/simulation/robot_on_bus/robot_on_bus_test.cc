#include "host_tools/simulation/robot_on_bus/robot_on_bus.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "host_tools/simulation/robot_on_bus/frame_log.h"
#include "tests/host_tools/simulation/robot_on_bus/mpc_driver.h"

namespace stilt::robot_on_bus {
namespace {

using testing_support::DrivenRobot;
using testing_support::MpcDriver;
using testing_support::RobotRequest;

constexpr gait::GaitCommand kStand{gait::GaitKind::stand, 0.0};
constexpr std::size_t kKneeLeft = 1;
constexpr double kFaultStart_s = 0.1;

/// A frame of the torso sensor in every tick, so that ticks can be counted.
RobotRequest every_tick(RobotRequest request) {
  request.settings.emplace_back("torso_sensor.rate_hz=1000");
  return request;
}

/// A robot that stands on its own, with a fault 0.1 s after the gantry has released the robot, advanced to
/// just before it.
class Standing {
 public:
  explicit Standing(const std::string& fault, RobotRequest request = {})
      : driven((request.faults.push_back(fault + "@0.1+0.05"), every_tick(request))), controller_(driven) {}

  [[nodiscard]] bool stand() {
    for (int i = 0; i < 4000 && driven.robot.walk_time_s().value_or(-1.0) < kFaultStart_s; ++i) tick();
    return driven.robot.walk_time_s().has_value() && driven.robot.injected_faults().empty();
  }
  void tick() { controller_.tick(kStand); }

  /// Frames of the robot on a bus in the last tick.
  [[nodiscard]] std::size_t frames(std::size_t bus) const { return driven.received(bus).size(); }

  /// Brings the drivers up before the controller looks at the robot.
  struct Enabled : DrivenRobot {
    explicit Enabled(const RobotRequest& request) : DrivenRobot(request) { EXPECT_TRUE(enable()); }
  };
  Enabled driven;

 private:
  MpcDriver controller_;
};

std::string frames_of(DrivenRobot& driven, int ticks) {
  MpcDriver controller(driven);
  std::string text;
  for (int i = 0; i < ticks; ++i) {
    controller.tick(kStand);
    for (std::size_t bus = 0; bus < 2; ++bus) {
      for (const hal::CanFrame& frame : driven.received(bus)) text += frame_text(frame) + "\n";
    }
  }
  return text;
}

TEST(RobotOnBus, EqualCallsGiveEqualFrames) {
  RobotRequest noisy;
  noisy.plant = {"encoder_noise_rad=0.001", "base_pitch_rate_noise_rad_s=0.01"};
  Standing::Enabled first(noisy), second(noisy);
  const std::string frames = frames_of(first, 2000);
  EXPECT_EQ(frames, frames_of(second, 2000));
  EXPECT_GT(frames.size(), 100'000u);
}

TEST(RobotOnBus, TheTorsoSensorSendsAtItsOwnRate) {
  for (const auto& [rate_hz, frames] : {std::pair{"500", 50u}, {"300", 30u}, {"5000", 100u}}) {
    RobotRequest request;
    request.settings.push_back(std::string("torso_sensor.rate_hz=") + rate_hz);
    DrivenRobot driven(request);
    std::size_t received = 0;
    for (int i = 0; i < 100; ++i) {
      driven.tick();
      received += driven.received(0).size();
      EXPECT_TRUE(i <= 10 || driven.base.missed_replies == 0) << rate_hz;
    }
    EXPECT_NEAR(static_cast<double>(received), frames, 1) << rate_hz;
  }
}

TEST(RobotOnBus, EveryCommandIsAnsweredAndTheTorsoSensorSendsOnceATick) {
  RobotRequest request;
  request.settings.emplace_back("torso_sensor.rate_hz=1000");
  Standing::Enabled driven(request);
  const hal::JointCommands nothing{};
  for (int i = 0; i < 10; ++i) {
    driven.tick(&nothing);
    EXPECT_EQ(driven.received(0).size(), 3u) << "two replies and the torso sensor";
    EXPECT_EQ(driven.received(1).size(), 2u);
    for (const hal::JointReading& joint : driven.readings) {
      EXPECT_EQ(joint.missed_replies, 0u);
      EXPECT_EQ(joint.state, hal::DriverState::enabled);
    }
  }
}

TEST(RobotOnBus, AWatchdogExpiresWhenNoCommandsCome) {
  Standing::Enabled driven({});
  for (int i = 0; i < 21; ++i) driven.tick();
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    EXPECT_FALSE(driven.robot.drivers().driver(joint).enabled());
  }
  const hal::JointCommands nothing{};
  driven.tick(&nothing);
  EXPECT_EQ(driven.readings[0].fault, hal::DriverFault::lost_communication);
}

TEST(RobotOnBus, FaultsWaitUntilTheGantryHasReleasedIt) {
  RobotRequest request;
  request.faults = {"driver-fault@0"};
  Standing::Enabled driven(request);
  const hal::JointCommands nothing{};
  for (int i = 0; i < 1000; ++i) driven.tick(&nothing);
  EXPECT_TRUE(driven.robot.injected_faults().empty());
}

TEST(RobotFault, DropSilencesAJointAndComesToAnEnd) {
  Standing robot("drop:knee_L");
  ASSERT_TRUE(robot.stand());
  robot.tick();
  ASSERT_EQ(robot.driven.robot.injected_faults().size(), 1u);
  for (int i = 0; i < 4; ++i) robot.tick();
  EXPECT_GE(robot.driven.readings[kKneeLeft].missed_replies, 4u);
  EXPECT_EQ(robot.driven.readings[0].missed_replies, 0u);
  for (int i = 0; i < 50; ++i) robot.tick();
  EXPECT_EQ(robot.driven.readings[kKneeLeft].missed_replies, 0u);
  EXPECT_EQ(robot.driven.readings[kKneeLeft].fault, hal::DriverFault::lost_communication)
      << "50 ms without a command are more than its watchdog bears";
}

TEST(RobotFault, DelayMakesFramesLate) {
  Standing robot("delay");
  ASSERT_TRUE(robot.stand());
  for (int i = 0; i < 4; ++i) robot.tick();
  EXPECT_EQ(robot.frames(0), 0u);
  for (int i = 0; i < 4; ++i) robot.tick();
  EXPECT_EQ(robot.frames(0), 3u);
}

TEST(RobotFault, DuplicateSendsFramesTwice) {
  Standing robot("duplicate:1");
  ASSERT_TRUE(robot.stand());
  for (int i = 0; i < 2; ++i) robot.tick();
  EXPECT_EQ(robot.frames(1), 4u);
  EXPECT_EQ(robot.frames(0), 3u) << "another bus";
}

TEST(RobotFault, CorruptMakesReadingsWrong) {
  Standing robot("corrupt");
  ASSERT_TRUE(robot.stand());
  for (int i = 0; i < 40; ++i) robot.tick();
  std::uint32_t odd = robot.driven.base.malformed;
  for (const hal::JointReading& joint : robot.driven.readings) odd += joint.malformed + joint.missed_replies;
  const auto wild = std::ranges::count_if(robot.driven.readings, [](const hal::JointReading& joint) {
    return std::abs(joint.velocity_rad_s) > 4 || joint.fault != hal::DriverFault::none;
  });
  EXPECT_GT(odd + static_cast<std::uint32_t>(wild), 0u);
}

TEST(RobotFault, BusOffSendsItsErrorFrameAndThenNothingUntilTheRestart) {
  Standing robot("bus-off:1");
  ASSERT_TRUE(robot.stand());
  robot.tick();
  ASSERT_EQ(robot.frames(1), 1u);
  EXPECT_TRUE(robot.driven.received(1)[0].error);
  EXPECT_EQ(robot.driven.received(1)[0].id, 0x40u);
  robot.tick();
  EXPECT_EQ(robot.frames(1), 0u);
  EXPECT_EQ(robot.frames(0), 3u);
  for (int i = 0; i < 49; ++i) robot.tick();
  ASSERT_EQ(robot.frames(1), 1u);
  EXPECT_TRUE(robot.driven.received(1)[0].error);
  EXPECT_EQ(robot.driven.received(1)[0].id, 0x100u);
  robot.tick();
  EXPECT_EQ(robot.frames(1), 2u);
}

TEST(RobotFault, DisconnectIsReportedToTheOwnerOfTheBus) {
  Standing robot("disconnect:0");
  ASSERT_TRUE(robot.stand());
  robot.tick();
  EXPECT_TRUE(robot.driven.robot.disconnected(0));
  EXPECT_FALSE(robot.driven.robot.disconnected(1));
  for (int i = 0; i < 60; ++i) robot.tick();
  EXPECT_FALSE(robot.driven.robot.disconnected(0));
}

TEST(RobotFault, ADriverFaultIsReportedAndTheMotorCoasts) {
  Standing robot("driver-fault:knee_L");
  ASSERT_TRUE(robot.stand());
  for (int i = 0; i < 2; ++i) robot.tick();
  EXPECT_EQ(robot.driven.readings[kKneeLeft].fault, hal::DriverFault::over_current);
  EXPECT_EQ(robot.driven.robot.drivers().torque_Nm(kKneeLeft), 0.0);
}

TEST(RobotFault, AFrozenEncoderRepeatsItself) {
  Standing robot("encoder-freeze:knee_L");
  ASSERT_TRUE(robot.stand());
  for (int i = 0; i < 20; ++i) robot.tick();
  EXPECT_GE(robot.driven.readings[kKneeLeft].unchanged_replies, 15u);
}

TEST(RobotFault, APowerCycleSilencesTheDriversAndTheyComeBackIdle) {
  Standing robot("power-cycle");
  ASSERT_TRUE(robot.stand());
  for (int i = 0; i < 5; ++i) robot.tick();
  EXPECT_GE(robot.driven.readings[0].missed_replies, 4u);
  EXPECT_EQ(robot.driven.robot.drivers().torque_Nm(kKneeLeft), 0.0);
  for (int i = 0; i < 50; ++i) robot.tick();
  EXPECT_EQ(robot.driven.readings[0].missed_replies, 0u);
  EXPECT_EQ(robot.driven.readings[0].state, hal::DriverState::idle);
}

TEST(RobotFault, LowVoltageLetsADriverThatDoesNotReportItGo) {
  Standing robot("low-voltage");
  ASSERT_TRUE(robot.stand());
  for (int i = 0; i < 2; ++i) robot.tick();
  EXPECT_EQ(robot.driven.readings[0].fault, hal::DriverFault::under_voltage);
}

TEST(RobotFault, LowVoltageIsReportedByADriverThatMeasuresIt) {
  RobotRequest moteus;
  moteus.settings = {"hip_driver.protocol=moteus", "knee_driver.protocol=moteus"};
  Standing robot("low-voltage", moteus);
  ASSERT_TRUE(robot.stand());
  EXPECT_EQ(robot.driven.readings[0].supply_V, 48.0);
  for (int i = 0; i < 2; ++i) robot.tick();
  EXPECT_EQ(robot.driven.readings[0].supply_V, 30.0);
  EXPECT_EQ(robot.driven.readings[0].fault, hal::DriverFault::none);
}

TEST(RobotFault, OverTemperatureIsReported) {
  Standing robot("over-temperature:hip_R");
  ASSERT_TRUE(robot.stand());
  for (int i = 0; i < 2; ++i) robot.tick();
  EXPECT_EQ(robot.driven.readings[2].driver_temperature_C, 120.0);
  EXPECT_EQ(robot.driven.readings[0].driver_temperature_C, 30.0);
}

TEST(RobotFault, TheEmergencyStopIsReported) {
  Standing robot("emergency-stop");
  ASSERT_TRUE(robot.stand());
  EXPECT_EQ(robot.driven.can.read_emergency_stop(robot.driven.now_ns), hal::EmergencyStopState::released);
  robot.tick();
  EXPECT_EQ(robot.driven.can.read_emergency_stop(robot.driven.now_ns), hal::EmergencyStopState::pressed);
}

TEST(RobotFault, ASilentTorsoSensorSendsNothing) {
  Standing robot("base-silent");
  ASSERT_TRUE(robot.stand());
  for (int i = 0; i < 5; ++i) robot.tick();
  EXPECT_EQ(robot.driven.base.missed_replies, 5u);
  EXPECT_EQ(robot.driven.readings[0].missed_replies, 0u);
}

TEST(RobotFault, AFrozenTorsoSensorRepeatsItself) {
  Standing robot("base-freeze");
  ASSERT_TRUE(robot.stand());
  for (int i = 0; i < 10; ++i) robot.tick();
  EXPECT_GE(robot.driven.base.unchanged_replies, 8u);
  EXPECT_EQ(robot.driven.base.missed_replies, 0u);
}

}  // namespace
}  // namespace stilt::robot_on_bus
