#include "hal/bring_up/bring_up.h"

#include <gtest/gtest.h>

#include <numbers>
#include <tuple>

#include "tests/hal/bring_up/bring_up_rig.h"

namespace stilt::hal::bring_up {
namespace {

using mock::FrameFault;
using mock::MockBus;

constexpr double kTurn_rad = 2 * std::numbers::pi;

TEST_F(BringUpTest, AMoteusComesUpWithItsWatchdogAndWithoutTorque) {
  moteus::MoteusEmulator driver = moteus::make_emulator({});
  driver.motor.position_rad = 1.25;
  bus_.attach(driver);
  MoteusBringUp bring_up({}, options_);
  const StepResult result = run(bring_up, bus_, clock_);
  EXPECT_EQ(result.stage, Stage::ready) << name(result.failure);
  EXPECT_TRUE(driver.enabled());
  EXPECT_NEAR(result.position_rad, 1.25, 1e-4);
  EXPECT_EQ(driver.torque_Nm(), 0);
}

TEST_F(BringUpTest, ADamiaoComesUpWithItsWatchdogAndWithoutTorque) {
  mit::MitEmulator driver = mit::make_emulator(damiao());
  driver.motor.position_rad = 1.25;
  bus_.attach(driver);
  MitBringUp bring_up(damiao(), options_);
  const StepResult result = run(bring_up, bus_, clock_);
  EXPECT_EQ(result.stage, Stage::ready) << name(result.failure);
  EXPECT_TRUE(driver.enabled());
  EXPECT_NEAR(result.position_rad, 1.25, 4e-4);
  EXPECT_NEAR(driver.torque_Nm(), 0, 0.005) << "half a step of the torque";
}

TEST_F(BringUpTest, AnOdriveComesUpWithItsWatchdogAndWithoutTorque) {
  odrive::OdriveEmulator driver = odrive::make_emulator({3, kEndpoints});
  driver.motor.position_rad = 1.25;
  bus_.attach(driver);
  OdriveBringUp bring_up({3, kEndpoints}, options_);
  const StepResult result = run(bring_up, bus_, clock_);
  EXPECT_EQ(result.stage, Stage::ready) << name(result.failure);
  EXPECT_TRUE(driver.enabled());
  EXPECT_NEAR(result.position_rad, 1.25, 1e-6);
  EXPECT_EQ(driver.torque_Nm(), 0);
}

/// A transmit queue that is full drops it, and nothing acknowledges it.
TEST_F(BringUpTest, AnOdriveWhoseFirstTorqueModeIsLostFollowsTorques) {
  odrive::OdriveEmulator driver = odrive::make_emulator({3, kEndpoints});
  bus_.attach(driver);
  OdriveBringUp bring_up({3, kEndpoints}, options_);
  const std::uint32_t mode = 3u << 5 | static_cast<std::uint32_t>(odrive::OdriveCommand::set_controller_mode);
  int modes = 0;
  StepResult result;
  for (int tick = 0; tick < 2000 && result.stage < Stage::ready; ++tick) {
    clock_.advance(kTick_ns);
    std::array<CanFrame, kMaximumBatch> received;
    const std::size_t count = bus_.receive(received).received;
    result = bring_up.step(clock_.now_ns(), std::span(received).first(count));
    const bool lost = result.send && result.frame.id == mode && ++modes == 1;
    if (result.send && !lost) {
      ASSERT_EQ(bus_.send(std::span(&result.frame, 1)).sent, 1u);
    }
  }
  ASSERT_EQ(result.stage, Stage::ready) << name(result.failure);
  EXPECT_EQ(modes, 3) << "before its watchdog is proved, and after";
  driver.motor.position_rad += 0.5;  // position control would pull it back
  CanFrame torque;
  ASSERT_EQ(odrive::encode_input_torque(3, 1.5, torque), EncodeStatus::ok);
  ASSERT_EQ(bus_.send(std::span(&torque, 1)).sent, 1u);
  std::array<CanFrame, kMaximumBatch> received;
  static_cast<void>(bus_.receive(received));
  EXPECT_EQ(driver.torque_Nm(), 1.5);
}

TEST_F(BringUpTest, AReadyDriverStaysEnabledAsLongAsStepsGoOnAndIsDisabledAfterwards) {
  moteus::MoteusEmulator moteus = moteus::make_emulator({});
  mit::MitEmulator mit = mit::make_emulator(damiao());
  odrive::OdriveEmulator odrive = odrive::make_emulator({3, kEndpoints});
  MoteusBringUp moteus_up({}, options_);
  MitBringUp mit_up(damiao(), options_);
  OdriveBringUp odrive_up({3, kEndpoints}, options_);
  const auto check = [this](EmulatedDriver& driver, BringUp& bring_up) {
    MockBus bus(clock_);
    bus.attach(driver);
    ASSERT_EQ(run(bring_up, bus, clock_).stage, Stage::ready);
    for (int tick = 0; tick < 200; ++tick) static_cast<void>(run(bring_up, bus, clock_, 1));
    EXPECT_TRUE(driver.enabled());
    std::array<CanFrame, kMaximumBatch> received;
    for (int tick = 0; tick < 22; ++tick) {  // the controller dies: its watchdog was 20 ms
      clock_.advance(kTick_ns);
      static_cast<void>(bus.receive(received));
    }
    EXPECT_FALSE(driver.enabled());
  };
  check(moteus, moteus_up);
  check(mit, mit_up);
  check(odrive, odrive_up);
  EXPECT_EQ(moteus.mode(), moteus::MoteusMode::timeout) << "which damps";
}

/// Answers every request with a wish for the next one.
class EndlessBringUp final : public BringUp {
 public:
  explicit EndlessBringUp(const Options& options) : BringUp(options) {}

 private:
  Ask ask(Stage, unsigned, CanFrame& frame) noexcept override {
    frame = classic_frame(1, 1);
    return Ask::wait_for_answer;
  }
  Verdict judge(Stage, unsigned, const CanFrame&) noexcept override { return Verdict::next_part; }
  bool keep_alive(CanFrame&) noexcept override { return false; }
};

TEST_F(BringUpTest, AStageWhoseDriverAnswersWithoutEndFailsInTime) {
  EndlessBringUp bring_up(options_);
  const CanFrame answer = classic_frame(2, 1);
  StepResult result;
  std::int64_t now_ns = 1'000'000'000;
  for (; now_ns < 10'000'000'000 && result.stage != Stage::failed; now_ns += kTick_ns) {
    result = bring_up.step(now_ns, std::span(&answer, 1));
  }
  EXPECT_EQ(result.failure, Failure::rejected);
  EXPECT_NEAR(static_cast<double>(now_ns) * 1e-9, 3.0, 0.1) << "2 s";
}

TEST_F(BringUpTest, AReadyDriverThatLosesItsPowerIsBroughtUpAnew) {
  moteus::MoteusEmulator moteus = moteus::make_emulator({});
  mit::MitEmulator mit = mit::make_emulator(damiao());
  odrive::OdriveEmulator odrive = odrive::make_emulator({3, kEndpoints});
  MoteusBringUp moteus_up({}, options_);
  MitBringUp mit_up(damiao(), options_);
  OdriveBringUp odrive_up({3, kEndpoints}, options_);
  const auto check = [this](EmulatedDriver& driver, BringUp& bring_up) {
    MockBus bus(clock_);
    bus.attach(driver);
    ASSERT_EQ(run(bring_up, bus, clock_).stage, Stage::ready);
    driver.set_powered(false);
    for (int tick = 0; tick < 40; ++tick) static_cast<void>(run(bring_up, bus, clock_, 1));
    driver.power_cycle();
    driver.set_powered(true);
    for (int tick = 0; tick < 400; ++tick) static_cast<void>(run(bring_up, bus, clock_, 1));
    EXPECT_EQ(bring_up.stage(), Stage::ready);
    EXPECT_TRUE(driver.enabled());
  };
  check(moteus, moteus_up);
  check(mit, mit_up);
  check(odrive, odrive_up);
}

TEST_F(BringUpTest, AReadyDriverThatIsGoneFailsAndAProgramThatStoodStillIsNoSilence) {
  moteus::MoteusEmulator driver = moteus::make_emulator({});
  bus_.attach(driver);
  MoteusBringUp bring_up({}, options_);
  ASSERT_EQ(run(bring_up, bus_, clock_).stage, Stage::ready);
  clock_.advance(15'000'000);  // within the watchdog
  EXPECT_EQ(run(bring_up, bus_, clock_, 1).stage, Stage::ready);
  driver.set_powered(false);
  StepResult result;
  for (int tick = 0; tick < 1000 && result.stage != Stage::failed; ++tick) {
    result = run(bring_up, bus_, clock_, 1);
  }
  EXPECT_EQ(result.failure, Failure::silent);
}

TEST_F(BringUpTest, AnAbsentDriverFailsInTheStageThatGotNoAnswer) {
  MoteusBringUp bring_up({}, options_);
  const StepResult result = run(bring_up, bus_, clock_);
  EXPECT_EQ(result.failure, Failure::silent);
  EXPECT_EQ(bus_.sent().size(), options_.tries);
  bus_.clear_sent();
  EXPECT_EQ(run(bring_up, bus_, clock_, 50).stage, Stage::failed);
  EXPECT_TRUE(bus_.sent().empty()) << "a failed bring-up sends nothing";
}

TEST_F(BringUpTest, LostAnswersAreAskedForAgain) {
  moteus::MoteusEmulator driver = moteus::make_emulator({});
  bus_.attach(driver);
  bus_.add_fault({.fault = FrameFault::lose, .until_ns = clock_.now_ns() + 45'000'000});
  MoteusBringUp bring_up({}, options_);
  EXPECT_EQ(run(bring_up, bus_, clock_).stage, Stage::ready);
}

TEST_F(BringUpTest, LateAndDoubledAnswersDoNotConfuseTheStages) {
  options_.longest_reply_lag_ns = 10 * kTick_ns;
  for (const FrameFault fault : {FrameFault::delay, FrameFault::duplicate}) {
    moteus::MoteusEmulator moteus = moteus::make_emulator({});
    mit::MitEmulator mit = mit::make_emulator(damiao());
    odrive::OdriveEmulator odrive = odrive::make_emulator({3, kEndpoints});
    MoteusBringUp moteus_up({}, options_);
    MitBringUp mit_up(damiao(), options_);
    OdriveBringUp odrive_up({3, kEndpoints}, options_);
    const auto check = [&](EmulatedDriver& driver, BringUp& bring_up) {
      MockBus bus(clock_);
      bus.attach(driver);
      bus.add_fault({.fault = fault, .delay_ns = 7'300'000});
      const StepResult result = run(bring_up, bus, clock_);
      EXPECT_EQ(result.stage, Stage::ready) << name(result.failure);
      EXPECT_TRUE(driver.enabled());
    };
    check(moteus, moteus_up);
    check(mit, mit_up);
    check(odrive, odrive_up);
  }
}

TEST_F(BringUpTest, DriversWithoutAWatchdogAreRefusedUnlessTheConfigurationAcceptsThem) {
  mit::MitEmulator driver = mit::make_emulator({});
  bus_.attach(driver);
  MitBringUp strict({}, options_);
  const StepResult refused = run(strict, bus_, clock_);
  EXPECT_EQ(refused.failure, Failure::no_watchdog);
  EXPECT_EQ(refused.setting, Setting::accepted_watchdog);
  EXPECT_FALSE(driver.enabled());
  options_.accept_missing_watchdog = true;
  MitBringUp accepting({}, options_);
  EXPECT_EQ(run(accepting, bus_, clock_).stage, Stage::ready);
  EXPECT_TRUE(driver.enabled());
}

TEST_F(BringUpTest, AnOdriveWithUnknownEndpointsHasNoWatchdogToPromise) {
  odrive::OdriveEmulator driver = odrive::make_emulator({3, kEndpoints});
  bus_.attach(driver);
  OdriveBringUp strict({3, {}}, options_);
  const StepResult refused = run(strict, bus_, clock_);
  EXPECT_EQ(refused.failure, Failure::no_watchdog);
  EXPECT_EQ(refused.setting, Setting::odrive_watchdog_endpoints);
  EXPECT_FALSE(driver.enabled());
}

TEST_F(BringUpTest, AMoteusWhosePositionMeansNothingIsRefused) {
  moteus::MoteusEmulator driver = moteus::make_emulator({});
  driver.set_home(moteus::MoteusHome::relative);
  bus_.attach(driver);
  MoteusBringUp bring_up({}, options_);
  EXPECT_EQ(run(bring_up, bus_, clock_).failure, Failure::not_home);
  options_.minimum_angle_rad = -0.3;
  options_.maximum_angle_rad = 0.3;
  driver.set_home(moteus::MoteusHome::rotor);
  MoteusBringUp rotor({}, options_);
  EXPECT_EQ(run(rotor, bus_, clock_).failure, Failure::not_home) << "one of many turns of the rotor";
  driver.set_home(moteus::MoteusHome::relative);
  options_.encoder_period_rad = 0.7;
  MoteusBringUp relative({}, options_);
  EXPECT_EQ(run(relative, bus_, clock_).failure, Failure::not_home)
      << "counted from where it was switched on";
}

TEST_F(BringUpTest, ExactlyOneTurnOfTheEncoderMustFitTheTravel) {
  moteus::MoteusEmulator driver = moteus::make_emulator({});
  driver.set_home(moteus::MoteusHome::rotor);
  driver.motor.position_rad = 0.1;
  bus_.attach(driver);
  options_.encoder_period_rad = 0.7;
  options_.minimum_angle_rad = 0.6;
  options_.maximum_angle_rad = 1.2;
  MoteusBringUp unique({}, options_);
  const StepResult result = run(unique, bus_, clock_);
  EXPECT_EQ(result.stage, Stage::ready) << name(result.failure);
  EXPECT_NEAR(result.turn_offset_rad, 0.7, 1e-12);
  EXPECT_NEAR(result.position_rad, 0.8, 1e-4);
  options_.maximum_angle_rad = 1.6;
  MoteusBringUp ambiguous({}, options_);
  EXPECT_EQ(run(ambiguous, bus_, clock_).failure, Failure::not_home);
}

/// Before its offset is known.
TEST_F(BringUpTest, AnyTurnOfTheRotorWillDoForAJointWithoutATravel) {
  for (const double period_rad : {0.0, 0.7}) {
    mock::MockBus bus(clock_);
    moteus::MoteusEmulator driver = moteus::make_emulator({});
    driver.set_home(moteus::MoteusHome::rotor);
    driver.motor.position_rad = 0.9;
    bus.attach(driver);
    options_.encoder_period_rad = period_rad;
    MoteusBringUp bring_up({}, options_);
    const StepResult result = run(bring_up, bus, clock_);
    EXPECT_EQ(result.stage, Stage::ready) << name(result.failure);
    EXPECT_NEAR(result.position_rad, 0.9, 1e-4);
    EXPECT_FALSE(bring_up.turn_known());
    driver.set_home(moteus::MoteusHome::output);
    EXPECT_EQ(run(bring_up, bus, clock_).stage, Stage::ready);
    bring_up.restart();
    EXPECT_EQ(run(bring_up, bus, clock_).stage, Stage::ready);
    EXPECT_TRUE(bring_up.turn_known());
  }
}

TEST_F(BringUpTest, AMoteusComesUpWithAnyGains) {
  for (int i = 1; i <= 400; ++i) {
    mock::MockBus bus(clock_);
    const moteus::MoteusDriver described{.kp_Nm_rev = 10.0 * i, .kd_Nm_s_rev = 0.5 * i};
    moteus::MoteusEmulator driver = moteus::make_emulator(described);
    bus.attach(driver);
    MoteusBringUp bring_up(described, options_);
    const StepResult result = run(bring_up, bus, clock_);
    ASSERT_EQ(result.stage, Stage::ready) << described.kp_Nm_rev << ": " << name(result.failure);
  }
}

/// Commands of a moteus reach 3.2767 revolutions from its zero, replies farther.
TEST_F(BringUpTest, AMoteusThatCountsFromTurnsAwayIsRefusedBeforeItIsEnabled) {
  options_.minimum_angle_rad = -2.4;
  options_.maximum_angle_rad = 2.4;
  for (const auto& [period_rad, turns, reaches] : {std::tuple{kTurn_rad, 0, true},
                                                   {kTurn_rad, 2, true},
                                                   {kTurn_rad, -2, true},
                                                   {kTurn_rad, 3, false},
                                                   {kTurn_rad, -3, false},
                                                   {kTurn_rad, 40, false},
                                                   {0.0, 0, true}}) {
    mock::MockBus bus(clock_);
    moteus::MoteusEmulator driver = moteus::make_emulator({});
    driver.motor.position_rad = 0.1 + turns * kTurn_rad;
    bus.attach(driver);
    options_.encoder_period_rad = period_rad;
    MoteusBringUp bring_up({}, options_);
    const StepResult result = run(bring_up, bus, clock_);
    EXPECT_EQ(result.stage, reaches ? Stage::ready : Stage::failed) << turns;
    EXPECT_EQ(driver.enabled(), reaches) << turns;
    EXPECT_EQ(result.failure, reaches ? Failure::none : Failure::wrong_setting) << turns;
    EXPECT_EQ(result.setting, reaches ? Setting::none : Setting::moteus_zero) << turns;
  }
}

TEST_F(BringUpTest, AJointOutsideItsTravelIsNotEnabled) {
  mit::MitEmulator driver = mit::make_emulator(damiao());
  driver.motor.position_rad = 3;
  bus_.attach(driver);
  options_.minimum_angle_rad = -1;
  options_.maximum_angle_rad = 1;
  MitBringUp bring_up(damiao(), options_);
  EXPECT_EQ(run(bring_up, bus_, clock_).failure, Failure::not_home);
  EXPECT_FALSE(driver.enabled());
}

TEST_F(BringUpTest, ADriverWithAFaultNamesIt) {
  mit::MitEmulator driver = mit::make_emulator(damiao());
  driver.raise(DriverFault::over_voltage);
  bus_.attach(driver);
  MitBringUp bring_up(damiao(), options_);
  const StepResult result = run(bring_up, bus_, clock_);
  EXPECT_EQ(result.failure, Failure::driver_fault);
  EXPECT_EQ(result.driver_fault, DriverFault::over_voltage);
}

TEST_F(BringUpTest, AnExpiredWatchdogIsClearedByBringingUpAgain) {
  moteus::MoteusEmulator driver = moteus::make_emulator({});
  bus_.attach(driver);
  MoteusBringUp bring_up({}, options_);
  ASSERT_EQ(run(bring_up, bus_, clock_).stage, Stage::ready);
  clock_.advance(1'000'000'000);
  std::array<CanFrame, 4> received;
  static_cast<void>(bus_.receive(received));
  ASSERT_EQ(driver.mode(), moteus::MoteusMode::timeout);
  bring_up.restart();
  EXPECT_EQ(run(bring_up, bus_, clock_).stage, Stage::ready);
  EXPECT_TRUE(driver.enabled());
}

TEST_F(BringUpTest, AWatchdogOfSecondsIsNone) {
  options_.watchdog_s = 2;
  MoteusBringUp bring_up({}, options_);
  EXPECT_EQ(run(bring_up, bus_, clock_).failure, Failure::invalid);
  EXPECT_TRUE(bus_.sent().empty());
}

}  // namespace
}  // namespace stilt::hal::bring_up
