#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/hal/bring_up/bring_up_rig.h"
#include "tests/hal/random_values.h"

// Drivers as they come from their vendors, and set up as docs/deployment.md says. It shows which come up, at
// every phase and rate of their clocks, and what a refusal names.
namespace stilt::hal::bring_up {
namespace {

using mock::FrameFault;

constexpr int kSeeds = 60;
constexpr double kWatchdogs_s[] = {0.005, 0.01, 0.02, 0.05, 0.1};
constexpr std::int64_t kMillisecond_ns = 1'000'000;

/// A driver whose clock is ahead of ours and runs at another rate.
class OtherClock final : public DriverAround<EmulatedDriver&> {
 public:
  OtherClock(EmulatedDriver& driver, double rate, std::int64_t ahead_ns)
      : DriverAround(driver), rate_(rate), ahead_ns_(ahead_ns) {}
  void take(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) noexcept override {
    inner_.take(at(now_ns), frame, replies);
  }
  void elapse(std::int64_t now_ns, FrameSink& replies) noexcept override {
    inner_.elapse(at(now_ns), replies);
  }

 private:
  [[nodiscard]] std::int64_t at(std::int64_t now_ns) const noexcept {
    return static_cast<std::int64_t>(static_cast<double>(now_ns) * rate_) + ahead_ns_;
  }
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

Case moteus_case(double enable_ms) {
  return {
      "moteus that takes " + std::to_string(enable_ms) + " ms",
      [enable_ms](auto& random) {
        auto settings = moteus::documented_settings(moteus_driver());
        settings.power_stage_ns =
            static_cast<std::int64_t>(random.between(enable_ms - 0.5, enable_ms + 0.5) * kMillisecond_ns) -
            settings.calibration_ns;
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
            settings.expires_in_idle = random.between(0, 1) < 0.5;
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
            auto driver =
                std::make_shared<MitEmulator>(described, mit::documented_settings(described), 5, behaviour);
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

TEST(VendorFirmware, DriversAsDocumentedComeUpAndStayUpAtEveryWatchdogPhaseAndClockRate) {
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

/// What an AK does with a fault when it is switched off is not public.
TEST(VendorFirmware, AnAkWithAFaultComesUpOrIsRefusedWithItUntilItsPowerIsGone) {
  const mit::MitDriver described = mit_driver(mit::ReplyLayout::ak);
  for (const bool keeps_fault : {false, true}) {
    MitEmulator driver(described, mit::documented_settings(described), 5, {.keeps_fault = keeps_fault});
    driver.raise(DriverFault::over_current);
    const auto bring_up = [&] {
      MitBringUp anew(described, {.accept_missing_watchdog = true});
      return attempt(driver, anew, 7).result;
    };
    const StepResult first = bring_up();
    EXPECT_EQ(first.stage, keeps_fault ? Stage::failed : Stage::ready) << name(first.failure);
    if (!keeps_fault) continue;
    EXPECT_EQ(first.failure, Failure::driver_fault);
    EXPECT_EQ(first.driver_fault, DriverFault::over_current);
    EXPECT_FALSE(driver.enabled());
    driver.power_cycle();
    EXPECT_EQ(bring_up().stage, Stage::ready) << "after its power was gone";
  }
}

/// Replies of a driver behind an adapter that holds them up for so long.
Trial attempt_behind(EmulatedDriver& driver, BringUp& bring_up, std::int64_t lag_ns) {
  mock::MockClock clock;
  mock::MockBus bus(clock);
  bus.attach(driver);
  bus.add_fault({.fault = FrameFault::delay, .delay_ns = lag_ns});
  return {.result = run(bring_up, bus, clock)};
}

TEST(ReplyLag, OfAnAdapterIsRefusedWithItsSizeByEveryProtocol) {
  for (const Case& which : documented_cases()) {
    for (const int lag_ms : {4, 8, 15, 19, 22, 30}) {
      stilt::hal::testing::RandomValues random(1);
      const auto driver = which.driver(random);
      const auto bring_up = which.bring_up({.accept_missing_watchdog = true});
      const Trial trial = attempt_behind(*driver, *bring_up, lag_ms * kMillisecond_ns);
      EXPECT_EQ(trial.result.failure, Failure::slow_reply) << which.name << ", " << lag_ms << " ms";
      EXPECT_NEAR(static_cast<double>(trial.result.reply_lag_ns) * 1e-6, lag_ms, 1.01) << which.name;
    }
  }
}

TEST(ReplyLag, OfLessThanTheLimitComesUp) {
  for (const Case& which : documented_cases()) {
    stilt::hal::testing::RandomValues random(1);
    const auto driver = which.driver(random);
    const auto bring_up = which.bring_up({.accept_missing_watchdog = true});
    const Trial trial = attempt_behind(*driver, *bring_up, 1'900'000);
    EXPECT_EQ(trial.result.stage, Stage::ready) << which.name << ": " << name(trial.result.failure);
    EXPECT_EQ(trial.result.reply_lag_ns, 2 * kMillisecond_ns) << which.name;
  }
}

TEST(ReplyLag, OfALateComputerIsMeasuredAgain) {
  MoteusEmulator driver = make_emulator(moteus_driver());
  MoteusBringUp bring_up(moteus_driver(), {});
  mock::MockClock clock;
  mock::MockBus bus(clock);
  bus.attach(driver);
  StepResult result;
  for (int late = 0; late < 4; ++late) {
    for (int tick = 0; tick < 100 && !result.send; ++tick) result = run(bring_up, bus, clock, 1);
    clock.advance(10 * kMillisecond_ns);  // the tick after the request is late
    result = run(bring_up, bus, clock, 1);
    EXPECT_EQ(result.stage, Stage::identify);
    EXPECT_EQ(result.reply_lag_ns, 11 * kMillisecond_ns);
  }
  EXPECT_EQ(run(bring_up, bus, clock).stage, Stage::ready);
}

}  // namespace
}  // namespace stilt::hal::bring_up
