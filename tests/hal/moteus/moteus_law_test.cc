#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "hal/moteus/moteus_driver.h"
#include "hal/moteus/moteus_emulator.h"

// The torque of a moteus against the law of the command, with its trajectory as the vendor ships it.
namespace stilt::hal::moteus {
namespace {

constexpr std::int64_t kTick_ns = 1'000'000;

MoteusDriver described() {
  MoteusDriver driver;
  driver.kp_Nm_rev = 2000;
  driver.kd_Nm_s_rev = 60;
  return driver;
}

/// Documented settings but for the limit of the acceleration, which firmware 1.0.0 sets to 50 rev/s^2.
class MoteusLaw : public ::testing::Test {
 protected:
  MoteusLaw() : driver_(described(), settings()) {
    for (int tick = 0; tick < 20; ++tick) command({.torque_limit_Nm = 0, .watchdog_s = 0.02});
  }
  static MoteusSettings settings() {
    MoteusSettings settings = documented_settings(described());
    settings.default_accel_limit_rev_s2 = 50;
    return settings;
  }
  void command(const DriverCommand& command) {
    CanFrame frame;
    ASSERT_EQ(command_frame(described(), command, frame), EncodeStatus::ok);
    send(frame);
  }
  void send(const CanFrame& frame) {
    FrameSink replies;
    driver_.take(now_ns_, frame, replies);
    now_ns_ += kTick_ns;
    driver_.elapse(now_ns_, replies);
  }

  MoteusEmulator driver_;
  std::int64_t now_ns_ = kTick_ns;
};

TEST_F(MoteusLaw, DampingAboutTheNewestReadingResistsAsTheLawSays) {
  ASSERT_TRUE(driver_.enabled());
  for (const double velocity_rad_s : {0.31, 1.26, 3.14, 6.28}) {
    driver_.motor.velocity_rad_s = velocity_rad_s;
    for (int tick = 0; tick < 200; ++tick) {
      driver_.motor.position_rad += velocity_rad_s * 1e-3;
      if (driver_.motor.position_rad > 2) driver_.motor.position_rad = -2;
      command({.position_rad = driver_.motor.position_rad,
               .kd_Nms_rad = 2,
               .torque_limit_Nm = 30,
               .watchdog_s = 0.02});
    }
    EXPECT_NEAR(driver_.torque_Nm(), -2 * velocity_rad_s, 0.01);
  }
}

TEST_F(MoteusLaw, AStepOfThePositionGivesItsTorqueWithTheNextTick) {
  command({.position_rad = 0.1, .kp_Nm_rad = 100, .torque_limit_Nm = 30, .watchdog_s = 0.02});
  EXPECT_NEAR(driver_.torque_Nm(), 10, 0.1);
}

// What the driver does with a command that leaves its limits alone. These are the figures of its firmware
// (db1a762), compiled and run on its own motor simulator with kd 2 Nm s/rad.
TEST_F(MoteusLaw, WithoutALimitInTheCommandTheTrajectoryCancelsDamping) {
  driver_.motor.velocity_rad_s = 6.28;
  for (int tick = 0; tick < 200; ++tick) {
    driver_.motor.position_rad += 6.28e-3;
    CanFrame frame;
    frame.id = 0x8001;
    frame.extended = frame.fd = true;
    SubframeWriter writer(frame);
    const double mode = 10;
    writer.values(SubframeKind::write, MoteusRegister::mode, Resolution::int8, std::span(&mode, 1));
    const std::array<double, 6> law{driver_.motor.position_rad / (2 * M_PI), 0, 0, 0,
                                    2 * 2 * M_PI / described().kd_Nm_s_rev,  30};
    writer.values(SubframeKind::write, MoteusRegister::command_position, Resolution::real, law);
    ASSERT_EQ(writer.finish(), EncodeStatus::ok);
    send(frame);
  }
  EXPECT_LT(std::abs(driver_.torque_Nm()), 1) << "the law says 12.56 Nm";
}

}  // namespace
}  // namespace stilt::hal::moteus
