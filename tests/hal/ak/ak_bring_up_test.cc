#include "hal/ak/ak_bring_up.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hal/ak/ak_emulator.h"
#include "tests/hal/bring_up/bring_up_rig.h"
#include "tests/hal/random_values.h"

namespace stilt::hal::ak {
namespace {

using bring_up::Failure;
using bring_up::Setting;
using bring_up::Stage;
using bring_up::StepResult;

class AkBringUpTest : public bring_up::BringUpTest {
 protected:
  AkBringUpTest() { options_.accept_missing_watchdog = true; }

  StepResult up(AkEmulator& emulator, const AkDriver& driver = {}) {
    AkBringUp bring_up(driver, options_);
    mock::MockBus bus(clock_);
    bus.attach(emulator);
    return run(bring_up, bus, clock_, 5000);
  }
  StepResult up(const AkSettings& settings, const AkDriver& driver = {}, const AkBehaviour& behaviour = {}) {
    AkEmulator emulator(driver, settings, behaviour);
    return up(emulator, driver);
  }
};

TEST_F(AkBringUpTest, ADriverComesUpLimpWhateverItHeldBefore) {
  AkEmulator emulator = make_emulator(AkDriver{});
  emulator.motor.position_rad = 1.25;
  CanFrame held;
  FrameSink none;
  ASSERT_EQ(encode_command({}, {.kp_Nm_rad = 500, .torque_Nm = 18}, held), EncodeStatus::ok);
  emulator.take(clock_.now_ns(), held, none);
  ASSERT_GT(std::abs(emulator.torque_Nm()), 1);
  bus_.attach(emulator);
  AkBringUp bring_up({}, options_);
  StepResult result = run(bring_up, bus_, clock_, 1);
  EXPECT_LE(std::abs(emulator.torque_Nm()), 0.005) << "with the first frame";
  result = run(bring_up, bus_, clock_);
  EXPECT_EQ(result.stage, Stage::ready) << name(result.failure);
  EXPECT_NEAR(result.position_rad, 1.25, kAkStatusStep_rad);
  EXPECT_FALSE(emulator.enabled());
  for (const CanFrame& frame : bus_.sent()) {
    EXPECT_EQ(frame, bus_.sent()[0]) << "limp commands, and nothing else";
    EXPECT_EQ(frame.length, 8);
  }
}

TEST_F(AkBringUpTest, WithoutAWatchdogItIsRefusedUnlessThatIsAccepted) {
  options_.accept_missing_watchdog = false;
  const StepResult refused = up(documented_settings({}));
  EXPECT_EQ(refused.failure, Failure::no_watchdog);
  EXPECT_EQ(refused.setting, Setting::accepted_watchdog);
}

TEST_F(AkBringUpTest, ADriverThatMakesNoSenseIsInvalid) {
  EXPECT_EQ(up(documented_settings({}), {.torque_Nm = 0}).failure, Failure::invalid);
}

TEST_F(AkBringUpTest, ADriverThatReportsTooSeldomIsNamedAndOneThatReportsNothingIsSilent) {
  for (const double rate_hz : {500.0, 450.0}) EXPECT_EQ(up({.status_rate_hz = rate_hz}).stage, Stage::ready);
  for (const double rate_hz : {250.0, 50.0, 10.0, 2.0}) {
    const StepResult result = up({.status_rate_hz = rate_hz});
    EXPECT_EQ(result.failure, Failure::wrong_setting) << rate_hz;
    EXPECT_EQ(result.setting, Setting::ak_v3_status_rate);
  }
  EXPECT_EQ(up({.status_rate_hz = 100}, {.status_rate_hz = 100}).stage, Stage::ready);
  AkEmulator off = make_emulator(AkDriver{});
  off.set_powered(false);
  EXPECT_EQ(up(off).failure, Failure::silent);
}

TEST_F(AkBringUpTest, PositionFramesThatTheConfigurationWantsMustCome) {
  const AkDriver fine{.position_frames = true};
  for (const bool first : {false, true}) {
    const AkBehaviour behaviour{.position_first = first, .long_position_frame = first};
    EXPECT_EQ(up(documented_settings(fine), fine, behaviour).stage, Stage::ready);
  }
  EXPECT_EQ(up(documented_settings(fine)).stage, Stage::ready) << "not wanted, and left aside";
  const StepResult result = up(documented_settings({}), fine);
  EXPECT_EQ(result.failure, Failure::wrong_setting);
  EXPECT_EQ(result.setting, Setting::ak_v3_position_frames);
}

TEST_F(AkBringUpTest, APositionOutsideTheTravelIsNotHome) {
  options_.minimum_angle_rad = -1;
  options_.maximum_angle_rad = 1;
  AkEmulator emulator = make_emulator(AkDriver{});
  emulator.motor.position_rad = 1.1;
  EXPECT_EQ(up(emulator).failure, Failure::not_home);
  AkEmulator one_turn({}, {.status_rate_hz = 500, .single_turn = true});
  one_turn.motor.position_rad = -0.5;
  EXPECT_EQ(up(one_turn).failure, Failure::not_home) << "it reports 5.8 rad";
}

TEST_F(AkBringUpTest, AFaultThatEndsIsWaitedForAndOneThatStaysIsNamed) {
  for (const bool keeps : {false, true}) {
    AkEmulator emulator({}, documented_settings({}), {.keeps_fault = keeps});
    emulator.raise(DriverFault::over_voltage);
    const StepResult result = up(emulator);
    EXPECT_EQ(result.stage, keeps ? Stage::failed : Stage::ready);
    EXPECT_EQ(result.failure, keeps ? Failure::driver_fault : Failure::none);
    EXPECT_EQ(result.driver_fault, keeps ? DriverFault::over_voltage : DriverFault::none);
    EXPECT_EQ(result.fault_code, keeps ? 3u : 0u);
  }
}

TEST_F(AkBringUpTest, AReadyDriverIsBroughtUpAnewAfterAFaultAndAPowerCycle) {
  for (const bool power : {false, true}) {
    AkEmulator emulator = make_emulator(AkDriver{});
    mock::MockBus bus(clock_);
    bus.attach(emulator);
    AkBringUp bring_up({}, options_);
    ASSERT_EQ(run(bring_up, bus, clock_).stage, Stage::ready);
    for (int tick = 0; tick < 100; ++tick)
      ASSERT_EQ(run(bring_up, bus, clock_, 1).stage, Stage::ready) << "it stays so";
    if (power) {
      emulator.power_cycle();
    } else {
      emulator.raise(DriverFault::encoder);
    }
    bool anew = false;
    for (int tick = 0; tick < 10; ++tick) anew = run(bring_up, bus, clock_, 1).stage != Stage::ready || anew;
    EXPECT_TRUE(anew);
    EXPECT_EQ(run(bring_up, bus, clock_).stage, Stage::ready);
  }
}

TEST_F(AkBringUpTest, AReadyDriverThatIsGoneFails) {
  AkEmulator emulator = make_emulator(AkDriver{});
  bus_.attach(emulator);
  AkBringUp bring_up({}, options_);
  ASSERT_EQ(run(bring_up, bus_, clock_).stage, Stage::ready);
  emulator.set_powered(false);
  StepResult result;
  for (int tick = 0; tick < 5000 && result.stage != Stage::failed; ++tick) {
    result = run(bring_up, bus_, clock_, 1);
  }
  EXPECT_EQ(result.failure, Failure::silent);
}

/// Frames get lost, doubled and delayed: it comes up, or says why not, and never pushes.
TEST_F(AkBringUpTest, OnABadBusItComesUpOrSaysWhyNot) {
  int ready = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    stilt::hal::testing::RandomValues random(seed);
    AkEmulator emulator({}, documented_settings({}),
                        {.position_first = random.chance(0.5), .keeps_fault = random.chance(0.5)});
    mock::MockBus bus(clock_);
    bus.attach(emulator);
    for (int i = 0; i < 6; ++i) {
      const std::int64_t from_ns = clock_.now_ns() + 1'000'000 * random.below(400);
      bus.add_fault({.fault = static_cast<mock::FrameFault>(random.below(3)),
                     .from_ns = from_ns,
                     .until_ns = from_ns + 1'000'000 * random.below(40),
                     .delay_ns = 1'000'000 * random.below(8)});
    }
    AkBringUp bring_up({}, options_);
    const StepResult result = run(bring_up, bus, clock_, 5000);
    EXPECT_TRUE(result.stage == Stage::ready || result.failure != Failure::none);
    EXPECT_LE(std::abs(emulator.torque_Nm()), 0.005);
    if (result.stage == Stage::ready) ++ready;
  }
  EXPECT_GE(ready, 55);
}

}  // namespace
}  // namespace stilt::hal::ak
