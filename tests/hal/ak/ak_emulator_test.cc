#include "hal/ak/ak_emulator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/hal/ak/ak_rig.h"
#include "tests/hal/hex.h"

// What the emulated driver does of what is known of it, and both ways of what is not.
namespace stilt::hal::ak {
namespace {

/// A driver on its own, and what it sends in so many milliseconds.
class Bench {
 public:
  explicit Bench(const AkSettings& settings = documented_settings({}), const AkBehaviour& behaviour = {})
      : driver({.torque_constant_Nm_A = 0.5}, settings, behaviour) {}

  std::vector<CanFrame> run(int milliseconds) {
    std::vector<CanFrame> all;
    for (int i = 0; i < milliseconds; ++i) {
      FrameSink sent;
      driver.elapse(now_ns_ += kTick_ns, sent);
      all.insert(all.end(), sent.frames().begin(), sent.frames().end());
    }
    return all;
  }
  void send(const CanFrame& frame) {
    FrameSink replies;
    driver.take(now_ns_, frame, replies);
    EXPECT_TRUE(replies.frames().empty()) << "it answers nothing";
  }
  void send(std::uint32_t id, const char* digits) {
    CanFrame frame;
    frame.id = id;
    frame.extended = true;
    send(stilt::hal::testing::with_payload(frame, digits));
  }
  void command(const AkCommand& command) {
    CanFrame frame;
    ASSERT_EQ(encode_command({}, command, frame), EncodeStatus::ok);
    send(frame);
  }
  AkStatus status() {
    AkStatus newest;
    for (const CanFrame& frame : run(5)) static_cast<void>(decode_status({}, frame, newest));
    return newest;
  }

  AkEmulator driver;

 private:
  std::int64_t now_ns_ = 1'000'000'000;
};

std::size_t count(const std::vector<CanFrame>& frames, AkReport report) {
  return static_cast<std::size_t>(
      std::ranges::count(frames, ak_id(report, 104), [](const CanFrame& frame) { return frame.id; }));
}

TEST(AkEmulator, ReportsAtItsRateByItsOwnClock) {
  for (const double rate_hz : {500.0, 250.0, 50.0, 1.0}) {
    Bench bench({.status_rate_hz = rate_hz});
    EXPECT_NEAR(static_cast<double>(count(bench.run(10'000), AkReport::status)), 10 * rate_hz, 1.1)
        << rate_hz;
  }
  Bench slow(documented_settings({}), {.clock_error = 0.01});
  EXPECT_NEAR(static_cast<double>(count(slow.run(10'000), AkReport::status)), 4950, 2);
}

TEST(AkEmulator, StartsWithItsFrameOnceAfterEachPowerUp) {
  Bench bench;
  EXPECT_EQ(count(bench.run(1000), AkReport::start), 1u);
  bench.driver.power_cycle();
  EXPECT_EQ(count(bench.run(1000), AkReport::start), 1u);
  Bench silent(documented_settings({}), {.sends_start = false});
  EXPECT_EQ(count(silent.run(1000), AkReport::start), 0u);
  bench.driver.set_powered(false);
  EXPECT_TRUE(bench.run(1000).empty());
}

TEST(AkEmulator, SendsPositionFramesWhereTheyAreOnInItsOrderAndLength) {
  for (const bool first : {false, true}) {
    Bench bench({.status_rate_hz = 500, .position_frames = true},
                {.position_first = first, .long_position_frame = first});
    bench.driver.motor.position_rad = 0.12345;
    const std::vector<CanFrame> frames = bench.run(2);
    ASSERT_EQ(frames.size(), 3u) << "the start, and a report";
    const CanFrame& position = frames[first ? 1 : 2];
    EXPECT_EQ(position.length, first ? 8 : 4);
    double position_rad = 0;
    ASSERT_EQ(decode_position({}, position, position_rad), DecodeStatus::ok);
    EXPECT_NEAR(position_rad, 0.12345, kAkPositionStep_rad);
  }
}

// The frames of docs/deployment.md, byte for byte.
TEST(AkEmulator, TakesItsFeedbackFromTheFrameOfTheDocuments) {
  Bench bench;
  EXPECT_EQ(count(bench.run(100), AkReport::position), 0u);
  bench.send(0x1068, "0000000000008000");
  EXPECT_GT(count(bench.run(100), AkReport::position), 40u);
  bench.send(0x1068, "0000000000000000");
  EXPECT_EQ(count(bench.run(100), AkReport::position), 0u);
}

TEST(AkEmulator, WithOneTurnItsPositionJumpsAtZero) {
  Bench bench({.status_rate_hz = 500, .single_turn = true});
  bench.driver.motor.position_rad = 0.01;
  EXPECT_NEAR(bench.status().position_rad, 0.01, kAkStatusStep_rad);
  bench.driver.motor.position_rad = -0.01;
  EXPECT_NEAR(bench.status().position_rad, 2 * std::numbers::pi - 0.01, kAkStatusStep_rad);
}

TEST(AkEmulator, HoldsItsLastCommandForEverOrUntilItsTimeout) {
  Bench bench;
  bench.command({.torque_Nm = 5});
  static_cast<void>(bench.run(60'000));
  EXPECT_NEAR(bench.driver.torque_Nm(), 5, 0.01);
  Bench watched({.status_rate_hz = 500, .command_timeout_ns = 100'000'000});
  watched.command({.torque_Nm = 5});
  static_cast<void>(watched.run(99));
  EXPECT_TRUE(watched.driver.enabled());
  static_cast<void>(watched.run(3));
  EXPECT_FALSE(watched.driver.enabled());
}

TEST(AkEmulator, ReadsWhatItGetsUnderTheIdentifierOfCommands) {
  Bench bench;
  bench.send(0x868, "fffffffffffffffc");
  EXPECT_EQ(bench.driver.torque_Nm(), 18) << "motor on of version 2: all that it has";
  bench.send(0x868, "640000");
  EXPECT_EQ(bench.driver.torque_Nm(), -18) << "a short command: the lower end of the position";
  bench.driver.power_cycle();
  CanFrame standard = classic_frame(0x68, 8);
  standard.data.fill(0xff);
  bench.send(standard);
  EXPECT_NEAR(bench.driver.torque_Nm(), 0, 0.005) << "no frame with 11 bits is for it";
}

TEST(AkEmulator, ANewZeroMovesWhatItHolds) {
  Bench bench;
  bench.driver.motor.position_rad = 1;
  bench.command({.position_rad = 1, .kp_Nm_rad = 10});
  EXPECT_NEAR(bench.driver.torque_Nm(), 0, 0.02);
  bench.send(origin_frame({}, true));
  EXPECT_NEAR(bench.driver.torque_Nm(), 10, 0.2) << "1 rad from the new zero";
  EXPECT_NEAR(bench.status().position_rad, 0, 1e-9);
}

TEST(AkEmulator, AZeroInFlashSurvivesAPowerCycleAndTheOtherDoesNot) {
  Bench bench;
  bench.driver.motor.position_rad = 0.3;
  bench.send(origin_frame({}, false));
  EXPECT_NEAR(bench.status().position_rad, 0, 1e-9);
  bench.driver.power_cycle();
  EXPECT_NEAR(bench.status().position_rad, 0.3, kAkStatusStep_rad);
  bench.send(origin_frame({}, true));
  bench.driver.power_cycle();
  EXPECT_NEAR(bench.status().position_rad, 0, 1e-9);
}

TEST(AkEmulator, WithoutPowerItKeepsNoCommandAndNoFault) {
  Bench bench(documented_settings({}), {.keeps_fault = true});
  bench.command({.torque_Nm = 5});
  bench.driver.raise(DriverFault::over_current);
  bench.driver.set_powered(false);
  static_cast<void>(bench.run(10));
  bench.driver.set_powered(true);
  EXPECT_EQ(count(bench.run(5), AkReport::start), 1u);
  EXPECT_EQ(bench.status().fault, DriverFault::none);
  EXPECT_FALSE(bench.driver.enabled());
}

TEST(AkEmulator, DisablesAndConfirmsItOnceWhereItKnowsTheFrame) {
  for (const bool knows : {true, false}) {
    Bench bench(documented_settings({}), {.knows_disable = knows});
    bench.command({.torque_Nm = 5});
    bench.send(0xf68, "");
    EXPECT_EQ(bench.driver.enabled(), !knows);
    int confirmed = 0;
    for (const CanFrame& frame : bench.run(100)) {
      AkStatus status;
      if (decode_status({}, frame, status) == DecodeStatus::ok && status.disabled) ++confirmed;
    }
    EXPECT_EQ(confirmed, knows ? 1 : 0);
    bench.command({.torque_Nm = 5});
    EXPECT_TRUE(bench.driver.enabled()) << "the next command drives again";
  }
}

TEST(AkEmulator, AFaultEndsByItselfOrWithThePower) {
  for (const bool keeps : {false, true}) {
    Bench bench(documented_settings({}), {.keeps_fault = keeps});
    bench.command({.torque_Nm = 5});
    bench.driver.raise(DriverFault::over_current);
    EXPECT_EQ(bench.driver.torque_Nm(), 0);
    EXPECT_EQ(bench.status().fault, DriverFault::over_current);
    static_cast<void>(bench.run(480));
    EXPECT_EQ(bench.status().fault, DriverFault::over_current);
    static_cast<void>(bench.run(20));
    EXPECT_EQ(bench.status().fault, keeps ? DriverFault::over_current : DriverFault::none);
    EXPECT_EQ(bench.driver.torque_Nm() > 4, !keeps) << "and then it drives on";
    bench.driver.power_cycle();
    EXPECT_EQ(bench.status().fault, DriverFault::none);
  }
}

TEST(AkEmulator, ItsCurrentHasTheSignOfTheTorqueOrThatOfDriving) {
  for (const bool driving : {false, true}) {
    Bench bench(documented_settings({}), {.current_of_driving = driving});
    bench.driver.motor.velocity_rad_s = -1;
    bench.command({.torque_Nm = 5});
    EXPECT_NEAR(bench.status().current_A, driving ? -10 : 10, 0.1) << "it brakes, with 0.5 Nm/A";
    bench.driver.lose_torque(true);
    EXPECT_EQ(bench.status().current_A, 0);
  }
}

}  // namespace
}  // namespace stilt::hal::ak
