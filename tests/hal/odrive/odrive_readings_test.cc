#include <gtest/gtest.h>

#include <array>
#include <memory>

#include "hal/odrive/odrive_driver.h"
#include "hal/odrive/odrive_emulator.h"
#include "hal/robot/can_robot.h"
#include "tests/hal/mock/mock_bus.h"

// Estimates come by the driver's own clock, whose phase crosses that of the reads.
namespace stilt::hal::odrive {
namespace {

constexpr std::int64_t kTick_ns = 1'000'000;

/// Four emulated drivers on two buses, read at 1 kHz.
class OdriveRobot {
 public:
  explicit OdriveRobot(double clock_error = 0) {
    OdriveSettings settings = documented_settings();
    settings.clock_error = clock_error;
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      const OdriveDriver driver{.node = static_cast<std::uint8_t>(1 + joint), .endpoints = {}};
      JointWiring& wiring = wiring_.joints[joint];
      wiring.bus = static_cast<std::uint8_t>(joint / 2);
      wiring.driver = driver;
      wiring.report_period_ticks = report_period_ticks(wiring.driver, 1000);
      drivers_[joint] = std::make_unique<OdriveEmulator>(driver, settings);
      buses_[wiring.bus].attach(*drivers_[joint]);
    }
    EXPECT_TRUE(valid(wiring_, 2));
    robot_ = std::make_unique<CanRobot>(wiring_, std::array<FrameBus*, 2>{&buses_[0], &buses_[1]});
    for (int i = 0; i < 20; ++i) tick();
  }

  JointBusStatus tick() {
    clock_.advance(kTick_ns);
    return robot_->read(clock_.now_ns(), readings_);
  }

  mock::MockClock clock_;
  std::array<mock::MockBus, 2> buses_{mock::MockBus(clock_), mock::MockBus(clock_)};
  RobotWiring wiring_;
  std::array<std::unique_ptr<OdriveEmulator>, kJoints> drivers_;
  std::unique_ptr<CanRobot> robot_;
  JointReadings readings_;
};

TEST(OdriveReadings, NothingIsMissedWhateverTheDriversClockDoes) {
  for (const double clock_error : {-1e-2, -1e-4, 0.0, 1e-4, 2e-4, 1e-2}) {
    OdriveRobot robot(clock_error);
    int without_news = 0;
    for (int i = 0; i < 20'000; ++i) {
      ASSERT_EQ(robot.tick(), JointBusStatus::ok) << clock_error << ", " << i;
      for (const JointReading& reading : robot.readings_) ASSERT_EQ(reading.missed_replies, 0u);
      without_news += robot.readings_[0].time_ns == robot.clock_.now_ns() ? 0 : 1;
    }
    EXPECT_EQ(without_news > 0, clock_error > 0) << "a slow clock leaves reads without an estimate";
  }
}

/// The driver's phase jitters about that of the reads: none and two estimates by turns.
TEST(OdriveReadings, ReadsOfNoneAndTwoEstimatesMissNothing) {
  OdriveRobot robot;
  for (const auto& driver : robot.drivers_) driver->set_powered(false);
  CanFrame estimates;
  for (int i = 0; i < 200; ++i) {
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      const auto node = static_cast<std::uint8_t>(1 + joint);
      ASSERT_EQ(encode(node, OdriveEstimates{1e-3 * i, 0}, estimates), EncodeStatus::ok);
      if (i % 2 == 0) continue;
      for (int copy = 0; copy < 2; ++copy)
        robot.buses_[joint / 2].script(estimates, robot.clock_.now_ns() + kTick_ns);
    }
    ASSERT_EQ(robot.tick(), JointBusStatus::ok) << i;
    for (const JointReading& reading : robot.readings_) ASSERT_EQ(reading.missed_replies, 0u);
  }
}

TEST(OdriveReadings, ASilentDriverIsLostOneReadLaterThanOneThatAnswers) {
  constexpr std::uint32_t kDamp = 10;  // supervisor.missed_damp_ticks
  OdriveRobot robot(2e-4);
  robot.drivers_[3]->set_powered(false);
  int ticks = 0;
  while (robot.readings_[3].missed_replies < kDamp && ticks < 100) {
    robot.tick();
    ++ticks;
  }
  EXPECT_EQ(ticks, 11);
  EXPECT_EQ(robot.readings_[0].missed_replies, 0u);
}

TEST(OdriveReadings, FeedbackEndsWithTheSixthReadWithoutAnEstimate) {
  OdriveRobot robot;
  robot.drivers_[0]->motor.velocity_rad_s = 2;
  robot.tick();
  JointCommands damping;
  damping.fill({.kd_Nms_rad = 1, .torque_limit_Nm = 50});
  const std::uint32_t estimates = 1u << 5 | static_cast<std::uint32_t>(OdriveCommand::encoder_estimates);
  robot.buses_[0].add_fault({.fault = mock::FrameFault::lose, .id = estimates, .any_id = false});
  for (int silent = 0; silent <= 10; ++silent) {
    robot.buses_[0].clear_sent();
    ASSERT_EQ(robot.robot_->write(damping), JointBusStatus::ok);
    double torque_Nm = 1e3;
    for (const CanFrame& frame : robot.buses_[0].sent())
      static_cast<void>(decode_input_torque(1, frame, torque_Nm));
    EXPECT_NEAR(torque_Nm, silent <= 5 ? -2 : 0, 1e-6) << silent;
    robot.tick();
  }
}

TEST(OdriveReadings, AnEstimateIsDueWithinTwoReadsOfAThousandPerSecond) {
  EXPECT_EQ(report_period_ticks(OdriveDriver{}, 1000), 2);
  EXPECT_EQ(report_period_ticks(OdriveDriver{}, 500), 2);
  EXPECT_EQ(report_period_ticks(OdriveDriver{}, 2000), 3);
}

}  // namespace
}  // namespace stilt::hal::odrive
