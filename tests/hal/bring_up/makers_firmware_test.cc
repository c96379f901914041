#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/hal/bring_up/bring_up_rig.h"
#include "tests/hal/random_values.h"

// Drivers as they come from their makers, and set up as docs/deployment.md says: which come up, at every
// phase and rate of their clocks, and what a refusal names.
namespace stilt::hal::bring_up {
namespace {

using mock::FrameFault;

constexpr int kSeeds = 60;
constexpr double kWatchdogs_s[] = {0.005, 0.01, 0.02, 0.05, 0.1};
constexpr std::int64_t kMillisecond_ns = 1'000'000;

/// A driver whose clock is ahead of ours and runs at another rate.
class OtherClock final : public EmulatedDriver {
 public:
  OtherClock(EmulatedDriver& driver, double rate, std::int64_t ahead_ns)
      : driver_(driver), rate_(rate), ahead_ns_(ahead_ns) {}
  void take(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) noexcept override {
    driver_.take(at(now_ns), frame, replies);
  }
  void elapse(std::int64_t now_ns, FrameSink& replies) noexcept override {
    driver_.elapse(at(now_ns), replies);
  }
  [[nodiscard]] double torque_Nm() const noexcept override { return driver_.torque_Nm(); }
  [[nodiscard]] bool enabled() const noexcept override { return driver_.enabled(); }
  [[nodiscard]] bool reports_supply() const noexcept override { return driver_.reports_supply(); }
  void raise(DriverFault fault) noexcept override { driver_.raise(fault); }
  void power_cycle() noexcept override { driver_.power_cycle(); }

 private:
  [[nodiscard]] std::int64_t at(std::int64_t now_ns) const noexcept {
    return static_cast<std::int64_t>(static_cast<double>(now_ns) * rate_) + ahead_ns_;
  }
  EmulatedDriver& driver_;
  double rate_;
  std::int64_t ahead_ns_;
};

struct Trial {
  StepResult result;
  double largest_torque_Nm = 0;  ///< at any time
  bool lasts = false;            ///< still enabled after a second of commands without torque
};

/// Brings `driver` up with ticks and answers that jitter.
Trial attempt(EmulatedDriver& driver, BringUp& bring_up, std::uint64_t seed) {
  stilt::hal::testing::RandomValues random(seed);
  mock::MockClock clock;
  mock::MockBus bus(clock);
  OtherClock other(driver, random.between(0.99, 1.01), static_cast<std::int64_t>(random.between(0, 1e8)));
  bus.attach(other);
  bus.add_fault(
      {.fault = FrameFault::delay, .delay_ns = static_cast<std::int64_t>(random.between(0.15e6, 0.9e6))});
  Trial trial;
  const auto tick = [&] {
    clock.advance(kTick_ns + static_cast<std::int64_t>(random.between(-0.2e6, 0.2e6)));
    std::array<CanFrame, kMaximumBatch> received;
    const std::size_t count = bus.receive(received).received;
    trial.result = bring_up.step(clock.now_ns(), std::span(received).first(count));
    if (trial.result.send) static_cast<void>(bus.send(std::span(&trial.result.frame, 1)));
    trial.largest_torque_Nm = std::max(trial.largest_torque_Nm, std::abs(driver.torque_Nm()));
    return trial.result.stage == Stage::ready || trial.result.stage == Stage::failed;
  };
  for (int i = 0; i < 2000 && !tick(); ++i) {
  }
  if (trial.result.stage != Stage::ready) return trial;
  for (int i = 0; i < 1000; ++i) tick();
  trial.lasts = driver.enabled();
  return trial;
}

/// A driver and its bring-up, anew for each seed.
struct Case {
  std::string name;
  std::function<std::shared_ptr<EmulatedDriver>(stilt::hal::testing::RandomValues&)> driver;
  std::function<std::shared_ptr<BringUp>(const Options&)> bring_up;
  double torque_step_Nm = 0;  ///< resolution of a command of zero
};

moteus::MoteusDriver moteus_driver() {
  moteus::MoteusDriver driver;
  driver.kp_Nm_rev = 800;
  driver.kd_Nm_s_rev = 40;
  return driver;
}

mit::MitDriver mit_driver(mit::ReplyLayout layout) {
  mit::MitDriver driver = damiao();
  driver.layout = layout;
  return driver;
}

Case moteus_case(double enable_ms) {
  return {"moteus that takes " + std::to_string(enable_ms) + " ms",
          [enable_ms](auto& random) {
            auto settings = moteus::documented_settings(moteus_driver());
            settings.enable_ns =
                static_cast<std::int64_t>(random.between(enable_ms - 0.5, enable_ms + 0.5) * kMillisecond_ns);
            auto driver = std::make_shared<MoteusEmulator>(moteus_driver(), settings);
            driver->motor.position_rad = random.between(-1, 1);
            return driver;
          },
          [](const Options& options) { return std::make_shared<MoteusBringUp>(moteus_driver(), options); }};
}

Case odrive_case(bool answers_heartbeat_request, bool setpoints_alone_feed, double enable_ms) {
  return {"ODrive " + std::to_string(answers_heartbeat_request) + std::to_string(setpoints_alone_feed) + " " +
              std::to_string(enable_ms) + " ms",
          [=](auto& random) {
            auto settings = odrive::documented_settings();
            settings.answers_heartbeat_request = answers_heartbeat_request;
            settings.setpoints_alone_feed = setpoints_alone_feed;
            settings.enable_ns = static_cast<std::int64_t>(enable_ms * kMillisecond_ns);
            auto driver = std::make_shared<OdriveEmulator>(odrive::OdriveDriver{3, kEndpoints}, settings);
            driver->motor.position_rad = random.between(-1, 1);
            return driver;
          },
          [](const Options& options) {
            return std::make_shared<OdriveBringUp>(odrive::OdriveDriver{3, kEndpoints}, options);
          }};
}

Case mit_case(mit::ReplyLayout layout, const mit::MitBehaviour& behaviour) {
  const mit::MitDriver described = mit_driver(layout);
  return {"MIT mode " + std::to_string(static_cast<int>(layout)) +
              std::to_string(behaviour.answers_before_frame) + std::to_string(behaviour.timeout_while_off) +
              std::to_string(behaviour.silent_while_off) + " " +
              std::to_string(behaviour.enable_ns / kMillisecond_ns) + " ms",
          [=](auto& random) {
            auto driver = std::make_shared<MitEmulator>(described, 5, behaviour);
            driver->motor.position_rad = random.between(-1, 1);
            return driver;
          },
          [=](const Options& options) { return std::make_shared<MitBringUp>(described, options); },
          step(described.torque_Nm, 12)};
}

std::vector<Case> documented_cases() {
  std::vector<Case> cases{moteus_case(12.5), moteus_case(30)};
  for (const bool request : {false, true}) {
    for (const bool setpoints : {false, true}) {
      for (const double enable_ms : {0.0, 30.0}) cases.push_back(odrive_case(request, setpoints, enable_ms));
    }
  }
  for (const bool before : {false, true}) {
    for (const bool while_off : {false, true}) {
      for (const std::int64_t enable_ns : {std::int64_t{0}, 30 * kMillisecond_ns}) {
        cases.push_back(mit_case(
            mit::ReplyLayout::damiao,
            {.answers_before_frame = before, .timeout_while_off = while_off, .enable_ns = enable_ns}));
      }
    }
  }
  for (const bool silent : {false, true}) {
    cases.push_back(mit_case(mit::ReplyLayout::ak, {.silent_while_off = silent}));
  }
  cases.push_back(mit_case(mit::ReplyLayout::mini_cheetah, {}));
  return cases;
}

TEST(MakersFirmware, DriversAsDocumentedComeUpAndStayUpAtEveryWatchdogPhaseAndClockRate) {
  for (const Case& which : documented_cases()) {
    for (const double watchdog_s : kWatchdogs_s) {
      for (int seed = 0; seed < kSeeds; ++seed) {
        stilt::hal::testing::RandomValues random(static_cast<std::uint64_t>(1000 + seed));
        const auto driver = which.driver(random);
        Options options;
        options.watchdog_s = watchdog_s;
        options.accept_missing_watchdog = true;
        options.minimum_angle_rad = -2.4;
        options.maximum_angle_rad = 2.4;
        const auto bring_up = which.bring_up(options);
        const Trial trial = attempt(*driver, *bring_up, static_cast<std::uint64_t>(seed));
        EXPECT_LE(trial.largest_torque_Nm, which.torque_step_Nm + 1e-12) << which.name << ", seed " << seed;
        ASSERT_TRUE(trial.lasts) << which.name << ", watchdog " << watchdog_s << " s, seed " << seed << ": "
                                 << name(trial.result.failure) << ", " << name(trial.result.driver_fault)
                                 << ", " << name(trial.result.setting);
      }
    }
  }
}

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
    constexpr odrive::OdriveDriver kDriver{3, {0x191, 0x192, 0x193}};
    OdriveEmulator driver(kDriver, settings);
    OdriveBringUp bring_up(kDriver, options_);
    return end(driver, bring_up);
  }

 private:
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
  EXPECT_EQ(moteus(settings).setting, Setting::moteus_ki);
}

TEST_F(FactorySettings, OfAnOdriveAreRefusedOneByOneByName) {
  odrive::OdriveSettings settings;
  EXPECT_EQ(odrive(settings).setting, Setting::odrive_torque_mode_limit);
  settings.torque_mode_limit = false;
  EXPECT_EQ(odrive(settings).setting, Setting::odrive_encoder_rate);
  settings.estimates_period_ns = kMillisecond_ns;
  EXPECT_EQ(odrive(settings).setting, Setting::odrive_heartbeat_rate);
  settings.heartbeat_period_ns = 10 * kMillisecond_ns;
  EXPECT_EQ(odrive(settings).stage, Stage::ready);
}

TEST_F(FactorySettings, AnOdriveOfFirmware05IsTooOldAndNotSilent) {
  odrive::OdriveSettings settings;
  settings.answers_version = false;
  EXPECT_EQ(odrive(settings).failure, Failure::old_version);
}

TEST_F(FactorySettings, AMoteusWithALatchedFaultComesUpAtTheFirstTry) {
  for (const bool timed_out : {false, true}) {
    MoteusEmulator driver = make_emulator(moteus_driver());
    bus_.attach(driver);
    if (timed_out) {
      MoteusBringUp first(moteus_driver(), options_);
      ASSERT_EQ(run(first, bus_, clock_).stage, Stage::ready);
      clock_.advance(50 * kMillisecond_ns);
      FrameSink none;
      driver.elapse(clock_.now_ns(), none);
      ASSERT_EQ(driver.mode(), moteus::MoteusMode::timeout);
    } else {
      driver.raise(DriverFault::gate_driver);
    }
    MoteusBringUp bring_up(moteus_driver(), options_);
    mock::MockBus bus(clock_);
    bus.attach(driver);
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
  MitEmulator driver(described);
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
