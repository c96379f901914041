#include <algorithm>
#include <vector>

#include "hal/mit/mit_driver.h"
#include "tests/hal/bring_up/bring_up_rig.h"
#include "tests/hal/random_values.h"

// Drivers as they come from their vendors: which setting a refusal names.
namespace stilt::hal::bring_up {
namespace {

constexpr int kSeeds = 60;
constexpr std::int64_t kMillisecond_ns = 1'000'000;

class FactorySettings : public BringUpTest {
 protected:
  FactorySettings() {
    options_.minimum_angle_rad = -2.4;
    options_.maximum_angle_rad = 2.4;
  }
  StepResult moteus(const moteus::MoteusSettings& settings, double position_rad = 0) {
    MoteusEmulator driver(moteus_driver(), settings);
    driver.motor.position_rad = position_rad;
    MoteusBringUp bring_up(moteus_driver(), options_);
    return end(driver, bring_up);
  }
  StepResult odrive(const odrive::OdriveSettings& settings) {
    constexpr odrive::OdriveDriver kDriver{3, {0x191, 0x192, 0x193, 0x194, 0x00060b, 0x04043a}};
    options_.maximum_speed_rad_s = 15;
    OdriveEmulator driver(kDriver, settings);
    OdriveBringUp bring_up(kDriver, options_);
    return end(driver, bring_up);
  }

  StepResult end(EmulatedDriver& driver, BringUp& bring_up) {
    mock::MockBus bus(clock_);
    bus.attach(driver);
    return run(bring_up, bus, clock_);
  }
};

TEST_F(FactorySettings, OfAMoteusAreRefusedOneByOneByName) {
  moteus::MoteusSettings settings;
  settings.firmware_version = 0x010000;
  const StepResult outside = moteus(settings, 0.5);
  EXPECT_EQ(outside.failure, Failure::driver_fault);
  EXPECT_EQ(outside.driver_fault, DriverFault::position_limit);
  EXPECT_EQ(outside.fault_code, 39u);
  EXPECT_EQ(outside.setting, Setting::moteus_position_bounds);
  const StepResult inside = moteus(settings, 0.01);
  EXPECT_EQ(inside.failure, Failure::wrong_setting) << "inside the bounds, which do not contain the travel";
  EXPECT_EQ(inside.setting, Setting::moteus_position_bounds);
  settings.bounds = {.minimum_rev = -1, .maximum_rev = 0.3};
  EXPECT_EQ(moteus(settings).setting, Setting::moteus_kp) << "the lower end shows 4 instead of 800 Nm/rev";
  settings.kp_Nm_rev = 800;
  EXPECT_EQ(moteus(settings).setting, Setting::moteus_kd);
  settings.kd_Nm_s_rev = 40;
  EXPECT_EQ(moteus(settings).setting, Setting::moteus_position_bounds) << "the upper end is cut off";
  settings.bounds.maximum_rev = 1;
  EXPECT_EQ(moteus(settings).stage, Stage::ready) << "no limit of the acceleration: it is in every command";
  settings.default_velocity_limit_rev_s = 2;
  EXPECT_EQ(moteus(settings).setting, Setting::moteus_trajectory_limits);
  settings.default_velocity_limit_rev_s = moteus::MoteusTrajectory::kUnset;
  settings.ki = 50;
  EXPECT_EQ(moteus(settings).stage, Stage::ready) << "servo.pid_position.ilimit is 0, as from the vendor";
  settings.ilimit_Nm = 10;
  EXPECT_EQ(moteus(settings).setting, Setting::moteus_ki);
}

TEST_F(FactorySettings, OfAMoteusThatNoRegisterShowsAreReadOverItsCommandLine) {
  moteus::MoteusSettings settings = moteus::documented_settings(moteus_driver());
  for (const auto mode : {moteus::MoteusTimeout::hold_position, moteus::MoteusTimeout::off}) {
    settings.timeout_mode = mode;
    const StepResult result = moteus(settings);
    EXPECT_EQ(result.failure, Failure::wrong_setting);
    EXPECT_EQ(result.setting, Setting::moteus_timeout_mode);
    EXPECT_EQ(result.stage, Stage::failed) << "before it is enabled";
  }
  settings.timeout_mode = moteus::MoteusTimeout::zero_velocity;
  settings.bemf_feedforward = 0.5;
  EXPECT_EQ(moteus(settings).setting, Setting::moteus_bemf_feedforward);
  settings.bemf_feedforward = 0;
  EXPECT_EQ(moteus(settings).stage, Stage::ready);
}

TEST_F(FactorySettings, OfAMoteusReadTheSameWhenEveryTwentiethFrameIsLost) {
  for (int seed = 0; seed < kSeeds; ++seed) {
    for (const bool right : {false, true}) {
      stilt::hal::testing::RandomValues random(static_cast<std::uint64_t>(seed));
      moteus::MoteusSettings settings = moteus::documented_settings(moteus_driver());
      if (!right) settings.timeout_mode = moteus::MoteusTimeout::hold_position;
      MoteusEmulator driver(moteus_driver(), settings);
      MoteusBringUp bring_up(moteus_driver(), options_);
      std::vector<CanFrame> received;
      StepResult result;
      FrameSink replies;
      for (int tick = 0; tick < 2000 && result.stage <= Stage::scaling; ++tick) {
        result = bring_up.step(tick * kTick_ns, received);
        received.clear();
        if (!result.send || random.chance(0.05)) continue;
        replies = {};
        driver.take(tick * kTick_ns, result.frame, replies);
        if (!random.chance(0.05)) received.assign(replies.frames().begin(), replies.frames().end());
      }
      EXPECT_EQ(result.failure, right ? Failure::none : Failure::wrong_setting) << "seed " << seed;
      EXPECT_EQ(result.setting, right ? Setting::none : Setting::moteus_timeout_mode) << "seed " << seed;
    }
  }
}

/// As tview leaves it, a text every so many milliseconds.
TEST_F(FactorySettings, OfAMoteusThatSendsTelemetryAreReadOnceThatIsStopped) {
  for (const std::int64_t period_ns :
       {kMillisecond_ns / 2, 2 * kMillisecond_ns, 7 * kMillisecond_ns, 100 * kMillisecond_ns}) {
    moteus::MoteusSettings settings = moteus::documented_settings(moteus_driver());
    settings.telemetry_ns = period_ns;
    const StepResult result = moteus(settings);
    EXPECT_EQ(result.stage, Stage::ready) << name(result.failure) << ", " << name(result.setting);
  }
}

/// Some texts fall between two answers: then it comes up.
TEST_F(FactorySettings, OfAMoteusWhoseCommandLineNeverEndsAreRefusedByThatName) {
  int refused = 0;
  for (int period_ms = 1; period_ms <= 12; ++period_ms) {
    moteus::MoteusSettings settings = moteus::documented_settings(moteus_driver());
    settings.telemetry_ns = period_ms * kMillisecond_ns;
    settings.telemetry_stops = false;
    const std::int64_t began_ns = clock_.now_ns();
    const StepResult result = moteus(settings);
    EXPECT_LT(clock_.now_ns() - began_ns, 1'000 * kMillisecond_ns);
    if (result.stage == Stage::ready) continue;
    ++refused;
    EXPECT_EQ(result.failure, Failure::rejected) << period_ms;
    EXPECT_EQ(result.setting, Setting::moteus_command_line) << period_ms;
  }
  EXPECT_GE(refused, 4);
}

TEST_F(FactorySettings, OfAnOdriveAreRefusedOneByOneByName) {
  odrive::OdriveSettings settings;
  EXPECT_EQ(odrive(settings).setting, Setting::odrive_torque_mode_limit);
  settings.torque_mode_limit = false;
  EXPECT_EQ(odrive(settings).setting, Setting::odrive_velocity_limit);
  settings.velocity_limit_rev_s = 2.39;
  EXPECT_EQ(odrive(settings).setting, Setting::odrive_encoder_rate) << "15.02 rad/s";
  settings.estimates_period_ns = 2 * kMillisecond_ns;
  EXPECT_EQ(odrive(settings).setting, Setting::odrive_encoder_rate) << "half of its reports would be missed";
  settings.estimates_period_ns = kMillisecond_ns;
  EXPECT_EQ(odrive(settings).setting, Setting::odrive_heartbeat_rate);
  settings.heartbeat_period_ns = 10 * kMillisecond_ns;
  EXPECT_EQ(odrive(settings).setting, Setting::odrive_torque_rate) << "it sends none, as from the vendor";
  settings.torques_period_ns = 20 * kMillisecond_ns;
  EXPECT_EQ(odrive(settings).setting, Setting::odrive_torque_rate);
  settings.torques_period_ns = 5 * kMillisecond_ns;
  EXPECT_EQ(odrive(settings).stage, Stage::ready);
}

TEST_F(FactorySettings, OfADamiaoAreRefusedOneByOneByName) {
  const mit::MitDriver described = damiao();
  const auto damiao_with = [&](const mit::MitSettings& settings) {
    MitEmulator driver(described, settings);
    MitBringUp bring_up(described, options_);
    return end(driver, bring_up);
  };
  mit::MitSettings settings;
  const StepResult factory = damiao_with(settings);
  EXPECT_EQ(factory.failure, Failure::wrong_setting) << "and not silence";
  EXPECT_EQ(factory.setting, Setting::damiao_reply_id);
  settings.reply_id = described.reply_id;
  settings.control_mode = 2;
  EXPECT_EQ(damiao_with(settings).setting, Setting::damiao_control_mode);
  settings.control_mode = 1;
  EXPECT_EQ(damiao_with(settings).setting, Setting::damiao_velocity_range) << "PMAX is as configured";
  settings.velocity_range_rad_s = described.velocity_rad_s.maximum;
  EXPECT_EQ(damiao_with(settings).setting, Setting::damiao_torque_range);
  settings.torque_range_Nm = described.torque_Nm.maximum;
  EXPECT_EQ(damiao_with(settings).stage, Stage::ready);
  settings.position_range_rad = 3.2;
  EXPECT_EQ(damiao_with(settings).setting, Setting::damiao_position_range);
}

TEST_F(FactorySettings, OfADamiaoWhoseRepliesHaveIdentifierZeroOnPurposeAreRight) {
  mit::MitDriver described = damiao();
  described.reply_id = 0;
  MitEmulator driver = mit::make_emulator(described);
  MitBringUp bring_up(described, options_);
  EXPECT_EQ(end(driver, bring_up).stage, Stage::ready);
}

TEST_F(FactorySettings, OfAnAkInServoModeAreRefusedByName) {
  options_.accept_missing_watchdog = true;
  const mit::MitDriver described = mit_driver(mit::ReplyLayout::ak);
  MitEmulator factory(described);
  MitBringUp bring_up(described, options_);
  const StepResult result = end(factory, bring_up);
  EXPECT_EQ(result.failure, Failure::wrong_setting) << "and not silence";
  EXPECT_EQ(result.setting, Setting::ak_control_mode);
  mit::MitSettings settings;
  settings.servo_mode = false;
  MitEmulator in_mit_mode(described, settings);
  MitBringUp again(described, options_);
  EXPECT_EQ(end(in_mit_mode, again).stage, Stage::ready);
}

/// By its firmware an AK answers with its own identifier or with 0.
TEST_F(FactorySettings, OfAnAkThatAnswersWithAnotherIdentifierNameIt) {
  options_.accept_missing_watchdog = true;
  const mit::MitDriver described = mit_driver(mit::ReplyLayout::ak);
  const auto answering_with = [&](std::uint16_t id) {
    mit::MitDriver as_it_is = described;
    as_it_is.reply_id = id;
    MitEmulator driver = mit::make_emulator(as_it_is);
    MitBringUp bring_up(described, options_);
    return end(driver, bring_up);
  };
  const StepResult own = answering_with(described.command_id);
  EXPECT_EQ(own.failure, Failure::silent);
  EXPECT_EQ(own.setting, Setting::ak_reply_id_own);
  const StepResult zero = answering_with(0);
  EXPECT_EQ(zero.failure, Failure::silent);
  EXPECT_EQ(zero.setting, Setting::ak_reply_id_zero);
  EXPECT_EQ(answering_with(described.reply_id).stage, Stage::ready);
}

TEST_F(FactorySettings, FramesThatNameASettingReachTheBringUpThroughTheFilterOfTheBus) {
  const auto receives = [](const mit::MitDriver& driver, std::uint32_t id, bool extended) {
    const std::vector<FrameId> ids = mit::receive_ids(driver);
    return std::ranges::any_of(ids,
                               [&](const FrameId& one) { return one.id == id && one.extended == extended; });
  };
  EXPECT_TRUE(receives(damiao(), 0, false));
  EXPECT_TRUE(receives(mit_driver(mit::ReplyLayout::ak), 0x2901, true));
  EXPECT_TRUE(receives(mit_driver(mit::ReplyLayout::ak), 0, false));
  EXPECT_TRUE(receives(mit_driver(mit::ReplyLayout::ak), 1, false));
  EXPECT_FALSE(receives(mit_driver(mit::ReplyLayout::mini_cheetah), 0, false));
}

TEST_F(FactorySettings, OfAnOdriveDisarmItAboveItsVelocityLimit) {
  odrive::OdriveSettings settings = odrive::documented_settings();
  settings.velocity_limit_rev_s = 2;
  OdriveEmulator driver({3, kEndpoints}, settings);
  bus_.attach(driver);
  OdriveBringUp bring_up({3, kEndpoints}, options_);
  ASSERT_EQ(run(bring_up, bus_, clock_).stage, Stage::ready);
  FrameSink none;
  driver.motor.velocity_rad_s = 15;
  driver.elapse(clock_.now_ns(), none);
  EXPECT_TRUE(driver.enabled());
  driver.motor.velocity_rad_s = 15.1;
  driver.elapse(clock_.now_ns(), none);
  EXPECT_FALSE(driver.enabled()) << "1.2 times 2 rev/s";
}

TEST_F(FactorySettings, AnOdriveOfFirmware05IsTooOldAndNotSilent) {
  odrive::OdriveSettings settings;
  settings.answers_version = false;
  EXPECT_EQ(odrive(settings).failure, Failure::old_version);
}

TEST_F(FactorySettings, AMoteusWithALatchedFaultComesUpAtTheFirstTry) {
  for (const bool timed_out : {false, true}) {
    MoteusEmulator driver = make_emulator(moteus_driver());
    mock::MockBus bus(clock_);
    bus.attach(driver);
    if (timed_out) {
      MoteusBringUp first(moteus_driver(), options_);
      ASSERT_EQ(run(first, bus, clock_).stage, Stage::ready);
      clock_.advance(50 * kMillisecond_ns);
      FrameSink none;
      driver.elapse(clock_.now_ns(), none);
      ASSERT_EQ(driver.mode(), moteus::MoteusMode::timeout);
    } else {
      driver.raise(DriverFault::gate_driver);
    }
    MoteusBringUp bring_up(moteus_driver(), options_);
    const StepResult result = run(bring_up, bus, clock_);
    EXPECT_EQ(result.stage, Stage::ready) << name(result.failure) << ", " << name(result.driver_fault);
  }
}

TEST_F(FactorySettings, AMoteusThatKeepsItsFaultNamesItWithItsCode) {
  MoteusEmulator driver = make_emulator(moteus_driver());
  bus_.attach(driver);
  MoteusBringUp bring_up(moteus_driver(), options_);
  StepResult result;
  for (int tick = 0; tick < 500 && result.stage != Stage::failed; ++tick) {
    driver.raise(DriverFault::gate_driver);
    result = run(bring_up, bus_, clock_, 1);
  }
  EXPECT_EQ(result.failure, Failure::driver_fault);
  EXPECT_EQ(result.driver_fault, DriverFault::gate_driver);
  EXPECT_EQ(result.fault_code, 33u);
}

TEST_F(FactorySettings, AMiniCheetahDoesNotFollowACommandOfBeforeItWasOn) {
  const mit::MitDriver described = mit_driver(mit::ReplyLayout::mini_cheetah);
  MitEmulator driver = mit::make_emulator(described);
  bus_.attach(driver);
  CanFrame old;
  ASSERT_EQ(encode_command(described, {.position_rad = 2, .kp_Nm_rad = 100}, old), EncodeStatus::ok);
  ASSERT_EQ(bus_.send(std::span(&old, 1)).sent, 1u);
  options_.accept_missing_watchdog = true;
  MitBringUp bring_up(described, options_);
  for (int tick = 0; tick < 500 && bring_up.stage() != Stage::ready; ++tick) {
    static_cast<void>(run(bring_up, bus_, clock_, 1));
    EXPECT_LE(std::abs(driver.torque_Nm()), step(described.torque_Nm, 12)) << tick;
  }
  EXPECT_EQ(bring_up.stage(), Stage::ready);
}

}  // namespace
}  // namespace stilt::hal::bring_up
