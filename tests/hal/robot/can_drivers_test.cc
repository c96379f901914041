#include "hal/robot/can_drivers.h"

#include <gtest/gtest.h>

#include <array>

#include "hal/robot/robot_hardware.h"
#include "tests/hal/robot/emulated_robot.h"

namespace stilt::hal {
namespace {

using testing::Kind;
using testing::kTick_ns;
using testing::Robot;

/// Emulated drivers as after power-up, behind the controller's hardware.
class Bench {
 public:
  explicit Bench(Kind kind) : robot(kind) {
    for (auto& driver : robot.drivers_) driver->power_cycle();
    for (bring_up::Options& driver : options) {
      driver.minimum_angle_rad = -10;
      driver.maximum_angle_rad = 10;
    }
  }

  /// Ticks until the drivers are ready or one failed, at most one second.
  BringUpProgress run() {
    const std::array<FrameBus*, 2> buses{&robot.buses_[0], &robot.buses_[1]};
    RobotHardware hardware(robot.wiring_, options, buses);
    return run(hardware);
  }

  BringUpProgress run(RobotHardware& hardware) {
    hardware.begin_bring_up();
    BringUpProgress progress;
    for (ticks = 0; ticks < 1000 && !progress.ready && !progress.failed; ++ticks) {
      RobotReadings readings;
      hardware.read(robot.clock_.now_ns(), readings);
      progress = hardware.bring_up(robot.clock_.now_ns());
      robot.clock_.advance(kTick_ns);
    }
    return progress;
  }

  Robot robot;
  BringUpOptions options;
  int ticks = 0;
};

TEST(CanDrivers, BringUpAllFourOfEveryVendor) {
  for (const Kind kind : {Kind::mit, Kind::moteus, Kind::odrive}) {
    Bench bench(kind);
    const BringUpProgress progress = bench.run();
    EXPECT_TRUE(progress.ready) << "stage " << name(progress.stage) << " of joint " << progress.joint << ": "
                                << name(progress.failure);
    for (auto& driver : bench.robot.drivers_) {
      EXPECT_TRUE(driver->enabled());
      EXPECT_NEAR(driver->torque_Nm(), 0, 0.0088) << "no torque but a step of the MIT mode";
    }
  }
}

TEST(CanDrivers, ReadyOnesAreKeptContentWhileOthersAreSlow) {
  Bench bench(Kind::mit);
  bench.robot.drivers_[3]->set_powered(false);
  const std::array<FrameBus*, 2> buses{&bench.robot.buses_[0], &bench.robot.buses_[1]};
  RobotHardware hardware(bench.robot.wiring_, bench.options, buses);
  hardware.begin_bring_up();
  for (int tick = 0; tick < 85; ++tick) {  // three times the watchdog, after the rest
    RobotReadings readings;
    hardware.read(bench.robot.clock_.now_ns(), readings);
    EXPECT_FALSE(hardware.bring_up(bench.robot.clock_.now_ns()).ready);
    bench.robot.clock_.advance(kTick_ns);
  }
  for (const std::size_t joint : {0u, 1u, 2u}) EXPECT_TRUE(bench.robot.drivers_[joint]->enabled()) << joint;
}

TEST(CanDrivers, TheOneThatFailsIsNamedWithItsStage) {
  Bench bench(Kind::mit);
  bench.robot.drivers_[2]->set_powered(false);
  const BringUpProgress progress = bench.run();
  EXPECT_TRUE(progress.failed);
  EXPECT_FALSE(progress.ready);
  EXPECT_EQ(progress.joint, 2u);
  EXPECT_EQ(progress.stage, bring_up::Stage::failed);
  EXPECT_EQ(progress.failure, bring_up::Failure::silent);
}

TEST(CanDrivers, AnExpiredWatchdogOfTheLastRunDoesNotStandInTheWay) {
  for (const Kind kind : {Kind::mit, Kind::moteus, Kind::odrive}) {
    Bench bench(kind);
    ASSERT_TRUE(bench.run().ready);
    for (int tick = 0; tick < 200; ++tick) {  // no commands
      bench.robot.clock_.advance(kTick_ns);
      static_cast<void>(bench.robot.read());
    }
    for (auto& driver : bench.robot.drivers_) ASSERT_FALSE(driver->enabled()) << "the watchdog expired";
    EXPECT_TRUE(bench.run().ready);
  }
}

TEST(CanDrivers, OfTwoThatFailTheFirstIsNamed) {
  Bench bench(Kind::moteus);
  for (const std::size_t joint : {0u, 2u}) bench.robot.drivers_[joint]->set_powered(false);
  const BringUpProgress progress = bench.run();
  EXPECT_TRUE(progress.failed);
  EXPECT_EQ(progress.joint, 0u);
}

TEST(CanDrivers, JointsOfOneBusComeUpOneAfterTheOther) {
  Bench bench(Kind::mit);
  bench.robot.drivers_[0]->set_powered(false);  // for ever in its first stage
  const std::array<FrameBus*, 2> buses{&bench.robot.buses_[0], &bench.robot.buses_[1]};
  RobotHardware hardware(bench.robot.wiring_, bench.options, buses);
  hardware.begin_bring_up();
  for (int tick = 0; tick < 65; ++tick) {
    RobotReadings readings;
    hardware.read(bench.robot.clock_.now_ns(), readings);
    EXPECT_FALSE(hardware.bring_up(bench.robot.clock_.now_ns()).ready);
    bench.robot.clock_.advance(kTick_ns);
  }
  EXPECT_FALSE(bench.robot.drivers_[1]->enabled()) << "behind the first one of its bus";
  EXPECT_TRUE(bench.robot.drivers_[2]->enabled());
  EXPECT_TRUE(bench.robot.drivers_[3]->enabled());
}

TEST(CanDrivers, TheTurnFoundAtBringUpIsInTheReadings) {
  Bench bench(Kind::moteus);
  const JointWiring& wiring = bench.robot.wiring_.joints[1];
  // The shaft at 0.1 rad of an encoder that repeats every 2 rad, in a travel of 3 to 4.5 rad: truly at 4.1
  // rad.
  bench.options[1].encoder_period_rad = 2;
  bench.options[1].minimum_angle_rad = 3;
  bench.options[1].maximum_angle_rad = 4.5;
  bench.robot.drivers_[1]->motor.position_rad = 0.1;
  const std::array<FrameBus*, 2> buses{&bench.robot.buses_[0], &bench.robot.buses_[1]};
  RobotHardware hardware(bench.robot.wiring_, bench.options, buses);
  ASSERT_TRUE(bench.run(hardware).ready);
  ASSERT_EQ(hardware.write({}), JointBusStatus::ok);
  RobotReadings readings;
  hardware.read(bench.robot.clock_.now_ns(), readings);
  EXPECT_NEAR(readings.joints[1].position_rad, wiring.direction * 4.1 / wiring.ratio + wiring.offset_rad,
              1e-4);
}

TEST(CanDrivers, StartingOverBringsThemUpAgain) {
  Bench bench(Kind::mit);
  const std::array<FrameBus*, 2> buses{&bench.robot.buses_[0], &bench.robot.buses_[1]};
  RobotHardware hardware(bench.robot.wiring_, bench.options, buses);
  ASSERT_TRUE(bench.run(hardware).ready);
  bench.robot.drivers_[1]->power_cycle();
  EXPECT_FALSE(bench.robot.drivers_[1]->enabled());
  EXPECT_TRUE(bench.run(hardware).ready);
  EXPECT_TRUE(bench.robot.drivers_[1]->enabled());
}

/// Reads so many times, with commands.
void command(Bench& bench, RobotHardware& hardware, int reads) {
  for (int read = 0; read < reads; ++read) {
    RobotReadings readings;
    hardware.read(bench.robot.clock_.now_ns(), readings);
    static_cast<void>(hardware.write({}));
    bench.robot.clock_.advance(kTick_ns);
  }
}

TEST(CanDrivers, OneThatCountsFromPowerUpIsRefusedAfterSilence) {
  for (const int silent_reads : {9, 12}) {
    for (const Kind kind : {Kind::mit, Kind::moteus, Kind::odrive}) {
      for (const double period_rad : {0.0, 15.0}) {
        Bench bench(kind);
        for (bring_up::Options& driver : bench.options) {
          driver.minimum_angle_rad = -7;
          driver.maximum_angle_rad = 7;
          driver.encoder_period_rad = period_rad;
        }
        const std::array<FrameBus*, 2> buses{&bench.robot.buses_[0], &bench.robot.buses_[1]};
        RobotHardware hardware(bench.robot.wiring_, bench.options, buses);
        ASSERT_TRUE(bench.run(hardware).ready);
        command(bench, hardware, 50);
        bench.robot.drivers_[2]->set_powered(false);
        command(bench, hardware, silent_reads);
        bench.robot.drivers_[2]->set_powered(true);
        command(bench, hardware, 50);
        const BringUpProgress progress = bench.run(hardware);
        const bool refused = kind == Kind::odrive && period_rad == 0 && silent_reads > 10;
        EXPECT_EQ(progress.ready, !refused) << name(progress.failure) << " after " << silent_reads;
        if (!refused) continue;
        EXPECT_TRUE(progress.failed);
        EXPECT_EQ(progress.failure, bring_up::Failure::void_offsets);
        EXPECT_EQ(progress.joint, 2u);
      }
    }
  }
}

TEST(CanDrivers, OneThatReportsWhileNoCommandLeavesHasItsPower) {
  Bench bench(Kind::odrive);
  const std::array<FrameBus*, 2> buses{&bench.robot.buses_[0], &bench.robot.buses_[1]};
  RobotHardware hardware(bench.robot.wiring_, bench.options, buses);
  ASSERT_TRUE(bench.run(hardware).ready);
  command(bench, hardware, 50);
  for (mock::MockBus& bus : bench.robot.buses_) bus.set_queue_full(true);
  command(bench, hardware, 15);
  for (mock::MockBus& bus : bench.robot.buses_) bus.set_queue_full(false);
  command(bench, hardware, 50);
  const BringUpProgress progress = bench.run(hardware);
  EXPECT_TRUE(progress.ready) << name(progress.failure);
}

TEST(CanDrivers, OneThatLosesItsPowerWhileOthersComeUpIsRefused) {
  Bench bench(Kind::odrive);
  bench.robot.drivers_[1]->set_powered(false);
  const std::array<FrameBus*, 2> buses{&bench.robot.buses_[0], &bench.robot.buses_[1]};
  RobotHardware hardware(bench.robot.wiring_, bench.options, buses);
  hardware.begin_bring_up();
  BringUpProgress progress;
  const auto step = [&](int ticks) {
    for (int tick = 0; tick < ticks && !progress.failed; ++tick) {
      RobotReadings readings;
      hardware.read(bench.robot.clock_.now_ns(), readings);
      progress = hardware.bring_up(bench.robot.clock_.now_ns());
      bench.robot.clock_.advance(kTick_ns);
    }
  };
  for (int tick = 0; tick < 300 && !bench.robot.drivers_[0]->enabled(); ++tick) step(1);
  step(100);  // its watchdog ends that once, and it is enabled again
  ASSERT_FALSE(progress.failed);
  bench.robot.drivers_[0]->set_powered(false);
  step(15);
  EXPECT_TRUE(progress.failed);
  EXPECT_EQ(progress.failure, bring_up::Failure::void_offsets);
  EXPECT_EQ(progress.joint, 0u);
}

}  // namespace
}  // namespace stilt::hal
