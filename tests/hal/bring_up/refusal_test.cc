#include <cmath>
#include <optional>

#include "tests/hal/bring_up/bring_up_rig.h"

// What keeps a driver from being enabled, vendor by vendor, and what does not.
namespace stilt::hal::bring_up {
namespace {

using mock::FrameFault;
using mock::MockBus;

/// A Damiao that confirms writes to its registers and forgets them, or whose answers get lost.
class BadDamiao final : public DriverAround<mit::MitEmulator> {
 public:
  explicit BadDamiao(const mit::MitDriver& driver)
      : DriverAround(mit::make_emulator(driver)), driver_(driver) {}
  bool forgets_writes = false;
  unsigned answers_every = 1;  ///< request

  void take(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) noexcept override {
    mit::DamiaoRegisterMessage message;
    if (forgets_writes && message_of(frame, message) && message.write) {
      CanFrame confirmation;
      if (encode_register_answer(driver_, message, confirmation) == EncodeStatus::ok)
        replies.push(confirmation);
      return;
    }
    FrameSink all;
    inner_.take(now_ns, frame, all);
    if (++requests_ % answers_every != 0) return;
    for (const CanFrame& reply : all.frames()) replies.push(reply);
  }

 private:
  bool message_of(const CanFrame& frame, mit::DamiaoRegisterMessage& message) const noexcept {
    return decode_register_request(driver_, frame, message) == DecodeStatus::ok;
  }

  mit::MitDriver driver_;
  unsigned requests_ = 0;
};

/// A moteus that answers position commands and stays stopped.
class StoppedMoteus final : public DriverAround<moteus::MoteusEmulator> {
 public:
  StoppedMoteus() : DriverAround(moteus::make_emulator({})) {}

  void take(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) noexcept override {
    constexpr std::uint8_t kPositionMode_bytes = 32;
    CanFrame instead = frame;
    if (frame.length == kPositionMode_bytes && !moteus::decode_console_request({}, frame))
      static_cast<void>(encode_query({}, moteus::MoteusQuery::state, instead));
    inner_.take(now_ns, instead, replies);
  }
};

class BringUpRefusal : public BringUpTest {
 protected:
  StepResult moteus(EmulatedDriver& driver) {
    MoteusBringUp bring_up({}, options_);
    return end(bring_up, driver);
  }
  StepResult damiao_driver(EmulatedDriver& driver, const mit::MitDriver& configured = damiao()) {
    MitBringUp bring_up(configured, options_);
    return end(bring_up, driver);
  }
  StepResult odrive(odrive::OdriveEmulator& driver, const odrive::OdriveEndpoints& endpoints = kEndpoints) {
    OdriveBringUp bring_up({3, endpoints}, options_);
    return end(bring_up, driver);
  }
  std::optional<mock::FaultRule> fault_;

 private:
  StepResult end(BringUp& bring_up, EmulatedDriver& driver) {
    MockBus bus(clock_);
    bus.attach(driver);
    if (fault_) bus.add_fault(*fault_);
    const StepResult result = run(bring_up, bus, clock_);
    EXPECT_EQ(driver.enabled(), result.stage == Stage::ready);
    return result;
  }
};

TEST_F(BringUpRefusal, AWatchdogThatReadsBackDifferentlyIsRefused) {
  moteus::MoteusEmulator moteus_driver = moteus::make_emulator({});
  moteus_driver.ignore_watchdog(true);
  EXPECT_EQ(moteus(moteus_driver).failure, Failure::wrong_watchdog);

  BadDamiao forgetful(damiao());
  forgetful.forgets_writes = true;
  EXPECT_EQ(damiao_driver(forgetful).failure, Failure::wrong_watchdog);
  fault_ = mock::FaultRule{.fault = FrameFault::delay, .delay_ns = 3 * kTick_ns};
  EXPECT_EQ(damiao_driver(forgetful).failure, Failure::wrong_watchdog)
      << "the confirmation comes when the value is awaited";

  // Bits of an ODrive's answer: a float's exponent; bit 0 of the switch, which is a float's last bit, too.
  for (const std::uint16_t bit : {std::uint16_t{32 + 23}, std::uint16_t{32}}) {
    fault_ =
        mock::FaultRule{.fault = FrameFault::corrupt,
                        .id = 3u << 5 | static_cast<std::uint32_t>(odrive::OdriveCommand::parameter_answer),
                        .any_id = false,
                        .bit = bit};
    odrive::OdriveEmulator odrive_driver = odrive::make_emulator({3, kEndpoints});
    EXPECT_EQ(odrive(odrive_driver).failure, Failure::wrong_watchdog) << bit;
  }
}

TEST_F(BringUpRefusal, FirmwareBelowTheMinimumIsRefusedAndTheMinimumIsNot) {
  for (const bool old : {true, false}) {
    const Failure expected = old ? Failure::old_version : Failure::none;
    options_.minimum_version = 0x010305;
    auto moteus_settings = moteus::documented_settings({});
    moteus_settings.firmware_version = old ? 0x010304 : 0x010305;
    moteus::MoteusEmulator moteus_driver({}, moteus_settings);
    EXPECT_EQ(moteus(moteus_driver).failure, expected);
    odrive::OdriveEndpoints endpoints = kEndpoints;
    endpoints.firmware_version = 0x010305;
    odrive::OdriveEmulator odrive_driver({3, endpoints}, odrive::documented_settings(),
                                         {2, 4, 4, 58, 1, 3, static_cast<std::uint8_t>(old ? 4 : 5), 0});
    EXPECT_EQ(odrive(odrive_driver, endpoints).failure, expected);
    options_.minimum_version = 8;
    mit::MitEmulator mit_driver(damiao(), mit::documented_settings(damiao()), old ? 7 : 8);
    EXPECT_EQ(damiao_driver(mit_driver).failure, expected);
  }
}

TEST_F(BringUpRefusal, RegistersOfOtherScalesThanOursAreRefused) {
  for (const auto& [version, expected] :
       {std::pair{4u, Failure::old_version}, {5u, Failure::none}, {6u, Failure::wrong_scaling}}) {
    auto settings = moteus::documented_settings({});
    settings.register_map_version = version;
    moteus::MoteusEmulator driver({}, settings);
    EXPECT_EQ(moteus(driver).failure, expected) << version;
  }
}

TEST_F(BringUpRefusal, AnyRangeThatDiffersFromTheConfigurationIsRefused) {
  using mit::MitDriver;
  for (mit::Range MitDriver::* range :
       {&MitDriver::position_rad, &MitDriver::velocity_rad_s, &MitDriver::torque_Nm,
        &MitDriver::reply_position_rad, &MitDriver::reply_velocity_rad_s, &MitDriver::reply_torque_Nm}) {
    for (const bool lower : {false, true}) {
      MitDriver configured = damiao();
      (lower ? (configured.*range).minimum : (configured.*range).maximum) *= 1.01;
      mit::MitEmulator driver = mit::make_emulator(damiao());
      EXPECT_EQ(damiao_driver(driver, configured).failure, Failure::wrong_scaling);
    }
  }
  mit::MitEmulator driver = mit::make_emulator(damiao());
  driver.report_torque_range(28);
  EXPECT_EQ(damiao_driver(driver).failure, Failure::wrong_scaling);
}

TEST_F(BringUpRefusal, ADamiaoInAnotherModeOrOfAnotherIdentifierIsRefused) {
  const auto with_register = [this](mit::DamiaoRegister number, std::uint32_t bits) {
    MitBringUp bring_up(damiao(), options_);
    CanFrame answer;
    StepResult result = bring_up.step(clock_.now_ns(), {});
    for (int part = 0; part < 2 && result.stage != Stage::failed; ++part) {
      mit::DamiaoRegisterMessage asked;
      EXPECT_EQ(decode_register_request(damiao(), result.frame, asked), DecodeStatus::ok);
      asked.bits = 1;  // identifier 1, MIT mode
      if (asked.number == static_cast<std::uint8_t>(number)) asked.bits = bits;
      EXPECT_EQ(encode_register_answer(damiao(), asked, answer), EncodeStatus::ok);
      result = bring_up.step(clock_.now_ns(), std::span(&answer, 1));
    }
    return result;
  };
  using mit::DamiaoRegister;
  EXPECT_EQ(with_register(DamiaoRegister::control_mode, 1).failure, Failure::none);
  EXPECT_EQ(with_register(DamiaoRegister::control_mode, 2).failure, Failure::wrong_identity);
  EXPECT_EQ(with_register(DamiaoRegister::command_id, 2).failure, Failure::wrong_identity);
}

TEST_F(BringUpRefusal, ATimeoutGoesOutInTheNearestUnit) {
  options_.watchdog_s = 0.00505;  // 101 units of 50 us; the quotient of the two doubles is below 101
  ASSERT_LT(options_.watchdog_s / mit::kDamiaoTimeoutUnit_s, 101);
  mit::MitEmulator driver = mit::make_emulator(damiao());
  bus_.attach(driver);
  MitBringUp bring_up(damiao(), options_);
  ASSERT_EQ(run(bring_up, bus_, clock_).stage, Stage::ready);
  std::optional<std::uint32_t> written;
  for (const CanFrame& frame : bus_.sent()) {
    mit::DamiaoRegisterMessage message;
    if (decode_register_request(damiao(), frame, message) == DecodeStatus::ok && message.write)
      written = message.bits;
  }
  EXPECT_EQ(written, 101u);
}

TEST_F(BringUpRefusal, EachRequestHasItsOwnTries) {
  BadDamiao lossy(damiao());
  lossy.answers_every = options_.tries;
  EXPECT_EQ(damiao_driver(lossy).failure, Failure::none) << "the last try of each is answered";
  BadDamiao mute(damiao());
  mute.answers_every = options_.tries + 1;
  EXPECT_EQ(damiao_driver(mute).failure, Failure::silent);
}

TEST_F(BringUpRefusal, ADriverThatAnswersAndDoesNotEnableIsNotSilent) {
  options_.watchdog_s = 0.1;  // does not expire meanwhile
  options_.answer_timeout_ns = 5 * kTick_ns;
  OdriveBringUp bring_up({3, kEndpoints}, options_);
  odrive::OdriveEmulator driver = odrive::make_emulator({3, kEndpoints});
  bus_.attach(driver);
  // Its heartbeat never says closed loop (8): one bit makes it 12.
  bus_.add_fault({.fault = FrameFault::corrupt,
                  .id = 3u << 5 | static_cast<std::uint32_t>(odrive::OdriveCommand::heartbeat),
                  .any_id = false,
                  .bit = 32 + 2});
  EXPECT_EQ(run(bring_up, bus_, clock_).failure, Failure::rejected);
  StoppedMoteus stopped;
  EXPECT_EQ(moteus(stopped).failure, Failure::rejected);
}

TEST_F(BringUpRefusal, WatchdogsFrom5To100MillisecondsAreAllowed) {
  for (const double allowed_s : {0.005, 0.1}) {
    options_.watchdog_s = allowed_s;
    moteus::MoteusEmulator driver = moteus::make_emulator({});
    EXPECT_EQ(moteus(driver).failure, Failure::none) << allowed_s;
  }
  for (const double refused_s : {0.0049, 0.1001, std::nan("")}) {
    options_.watchdog_s = refused_s;
    moteus::MoteusEmulator driver = moteus::make_emulator({});
    EXPECT_EQ(moteus(driver).failure, Failure::invalid) << refused_s;
  }
}

TEST_F(BringUpRefusal, AnOdriveWithAnErrorNamesItAfterItWasCleared) {
  odrive::OdriveEmulator driver = odrive::make_emulator({3, kEndpoints});
  driver.raise(DriverFault::over_voltage);
  EXPECT_EQ(odrive(driver).failure, Failure::none) << "cleared";
  // Bit 8 of the heartbeat's errors: over voltage, whatever is cleared.
  fault_ = mock::FaultRule{.fault = FrameFault::corrupt,
                           .id = 3u << 5 | static_cast<std::uint32_t>(odrive::OdriveCommand::heartbeat),
                           .any_id = false,
                           .bit = 8};
  odrive::OdriveEmulator faulty = odrive::make_emulator({3, kEndpoints});
  OdriveBringUp bring_up({3, kEndpoints}, options_);
  bus_.attach(faulty);
  bus_.add_fault(*fault_);
  const StepResult result = run(bring_up, bus_, clock_);
  EXPECT_EQ(result.failure, Failure::driver_fault);
  EXPECT_EQ(result.driver_fault, DriverFault::over_voltage);
}

TEST_F(BringUpRefusal, BeginningAgainForgetsTheFailureAndThePlace) {
  options_.minimum_angle_rad = 1;
  options_.maximum_angle_rad = 2;
  moteus::MoteusEmulator driver = moteus::make_emulator({});
  driver.motor.position_rad = 3;
  bus_.attach(driver);
  MoteusBringUp bring_up({}, options_);
  ASSERT_EQ(run(bring_up, bus_, clock_).failure, Failure::not_home);
  driver.motor.position_rad = 1.5;
  bring_up.restart();
  const StepResult result = run(bring_up, bus_, clock_);
  EXPECT_EQ(result.stage, Stage::ready);
  EXPECT_EQ(result.failure, Failure::none);
  EXPECT_NEAR(result.position_rad, 1.5, 1e-4);
  bring_up.restart();
  EXPECT_TRUE(std::isnan(bring_up.step(clock_.now_ns(), {}).position_rad));
}

}  // namespace
}  // namespace stilt::hal::bring_up
