#include <bit>
#include <map>

#include "tests/hal/bring_up/bring_up_rig.h"

// Endpoints of an ODrive that are not those of its watchdog, and a watchdog that is proved before it is
// relied upon.
namespace stilt::hal::bring_up {
namespace {

using odrive::OdriveParameter;

constexpr std::uint16_t kOtherNumber = 50, kOtherSwitch = 51, kNothing = 52;

std::uint32_t bits_of(float value) { return std::bit_cast<std::uint32_t>(value); }

/// An ODrive whose watchdog is at kEndpoints, with other parameters at other numbers.
class ParameterOdrive final : public DriverAround<OdriveEmulator> {
 public:
  std::map<std::uint16_t, OdriveParameter> parameters{{kOtherNumber, {.bits = bits_of(2.5F)}},
                                                      {kOtherSwitch, {.bits = 0, .value_bytes = 1}}};
  std::map<std::uint16_t, std::uint32_t> kept;  ///< what a write leaves there, whatever is written
  int writes = 0;

  explicit ParameterOdrive(const odrive::OdriveSettings& settings = odrive::documented_settings())
      : DriverAround(OdriveEmulator({3, kEndpoints}, settings)) {}

  void take(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) noexcept override {
    OdriveParameter request;
    const bool asks = decode_parameter_request(3, frame, request) == DecodeStatus::ok;
    if (asks && request.write) ++writes;
    inner_.motor = motor;
    inner_.take(now_ns, frame, replies);
    const auto found = parameters.find(request.endpoint);
    if (!asks || found == parameters.end()) return;
    if (request.write) {
      const auto keeps = kept.find(request.endpoint);
      found->second.bits = keeps == kept.end() ? request.bits : keeps->second;
      return;
    }
    CanFrame answer;
    OdriveParameter value = found->second;
    value.endpoint = request.endpoint;
    EXPECT_EQ(encode_parameter_answer(3, value, answer), EncodeStatus::ok);
    replies.push(answer);
  }

  [[nodiscard]] std::uint32_t bits(std::uint16_t endpoint) const { return parameters.at(endpoint).bits; }
};

class OdriveWatchdog : public BringUpTest {
 protected:
  StepResult end(EmulatedDriver& driver, const odrive::OdriveEndpoints& endpoints) {
    mock::MockBus bus(clock_);
    bus.attach(driver);
    OdriveBringUp bring_up({3, endpoints}, options_);
    const StepResult result = run(bring_up, bus, clock_);
    EXPECT_EQ(driver.enabled(), result.stage == Stage::ready);
    return result;
  }
  static odrive::OdriveEndpoints with(std::uint16_t timeout, std::uint16_t enable) {
    odrive::OdriveEndpoints endpoints = kEndpoints;
    endpoints.watchdog_timeout = timeout;
    endpoints.enable_watchdog = enable;
    return endpoints;
  }
  void expect_refused(const StepResult& result) {
    EXPECT_EQ(result.failure, Failure::wrong_watchdog) << name(result.failure);
    EXPECT_EQ(result.setting, Setting::odrive_other_endpoints);
  }
};

TEST_F(OdriveWatchdog, OtherParametersThatReadBackAreRefusedAndKeepTheirValues) {
  for (const double watchdog_s : {0.005, 0.02, 0.1}) {
    options_.watchdog_s = watchdog_s;
    ParameterOdrive driver;
    expect_refused(end(driver, with(kOtherNumber, kOtherSwitch)));
    EXPECT_EQ(driver.writes, 4) << "there and back";
    EXPECT_EQ(driver.bits(kOtherNumber), bits_of(2.5F));
    EXPECT_EQ(driver.bits(kOtherSwitch), 0u);
  }
}

TEST_F(OdriveWatchdog, OneOfBothThatIsAnotherParameterIsRefusedAndKeepsItsValue) {
  ParameterOdrive time_alone;
  expect_refused(end(time_alone, with(kEndpoints.watchdog_timeout, kOtherSwitch)));
  EXPECT_EQ(time_alone.bits(kOtherSwitch), 0u);
  ParameterOdrive switch_alone;  // its time is 0, so that it never stays in closed loop
  EXPECT_EQ(end(switch_alone, with(kOtherNumber, kEndpoints.enable_watchdog)).failure, Failure::driver_fault);
  EXPECT_EQ(switch_alone.bits(kOtherNumber), bits_of(2.5F));
}

/// A watchdog of another time, and one that stays off. Nothing else would show them before the joint is on.
TEST_F(OdriveWatchdog, WhatReadsBackDifferentlyIsRefusedBeforeItIsEnabled) {
  const std::pair<std::uint16_t, std::uint32_t> wrong[] = {
      {kOtherNumber, bits_of(static_cast<float>(options_.watchdog_s) + 1e-3F)}, {kOtherSwitch, 0}};
  for (const auto& [endpoint, bits] : wrong) {
    mock::MockBus bus(clock_);
    ParameterOdrive driver;
    driver.kept[endpoint] = bits;
    bus.attach(driver);
    OdriveBringUp bring_up({3, with(kOtherNumber, kOtherSwitch)}, options_);
    StepResult result;
    for (int tick = 0; tick < 2000 && result.stage < Stage::ready; ++tick) {
      result = run(bring_up, bus, clock_, 1);
      ASSERT_FALSE(driver.enabled()) << endpoint;
    }
    expect_refused(result);
  }
}

TEST_F(OdriveWatchdog, ErrorsAreClearedAgainWhereTheFirstTimeWasLost) {
  OdriveEmulator driver = odrive::make_emulator({3, kEndpoints});
  mock::MockBus bus(clock_);
  bus.attach(driver);
  driver.raise(DriverFault::over_voltage);
  OdriveBringUp bring_up({3, kEndpoints}, options_);
  StepResult result;
  int lost = 0;
  for (int tick = 0; tick < 4000 && result.stage < Stage::ready; ++tick) {
    result = run(bring_up, bus, clock_, 1);
    odrive::OdriveCommand command{};
    const bool clears = result.send && decode_command(3, result.frame, command) == DecodeStatus::ok &&
                        command == odrive::OdriveCommand::clear_errors;
    if (clears && lost++ == 0) driver.raise(DriverFault::over_voltage);
  }
  EXPECT_EQ(result.stage, Stage::ready) << name(result.failure);
  EXPECT_GT(lost, 1);
}

TEST_F(OdriveWatchdog, OtherParametersKeepTheirValuesWhereSomethingElseIsRefused) {
  options_.minimum_angle_rad = 1;
  options_.maximum_angle_rad = 2;
  ParameterOdrive driver;
  EXPECT_EQ(end(driver, with(kOtherNumber, kOtherSwitch)).failure, Failure::not_home);
  EXPECT_EQ(driver.writes, 4);
  EXPECT_EQ(driver.bits(kOtherNumber), bits_of(2.5F));
  EXPECT_EQ(driver.bits(kOtherSwitch), 0u);
}

TEST_F(OdriveWatchdog, WhatIsNoTimeOrNoSwitchIsNeverWritten) {
  for (const OdriveParameter& no_time : {OdriveParameter{.bits = 20},
                                         {.bits = bits_of(-1)},
                                         {.bits = bits_of(2e4F)},
                                         {.bits = bits_of(std::nanf(""))},
                                         {.bits = 0, .value_bytes = 1}}) {
    ParameterOdrive driver;
    driver.parameters[kOtherNumber] = no_time;
    expect_refused(end(driver, with(kOtherNumber, kEndpoints.enable_watchdog)));
    EXPECT_EQ(driver.writes, 0) << no_time.bits;
  }
  for (const OdriveParameter& no_switch :
       {OdriveParameter{.bits = 2, .value_bytes = 1}, {.bits = bits_of(1)}}) {
    ParameterOdrive driver;
    driver.parameters[kOtherSwitch] = no_switch;
    expect_refused(end(driver, with(kEndpoints.watchdog_timeout, kOtherSwitch)));
    EXPECT_EQ(driver.writes, 0) << no_switch.bits;
  }
  ParameterOdrive driver;
  expect_refused(end(driver, with(kNothing, kOtherSwitch)));
  EXPECT_EQ(driver.writes, 0) << "no such endpoint";
}

TEST_F(OdriveWatchdog, StoredTimesAreOverwritten) {
  for (const float stored_s : {0.0F, 1e-3F, 1.0F, 100.0F}) {
    mock::MockBus bus(clock_);
    OdriveEmulator driver = odrive::make_emulator({3, kEndpoints});
    bus.attach(driver);
    CanFrame frame;
    ASSERT_EQ(
        odrive::encode_parameter_request(
            3, {.write = true, .endpoint = kEndpoints.watchdog_timeout, .bits = bits_of(stored_s)}, frame),
        EncodeStatus::ok);
    ASSERT_EQ(bus.send(std::span(&frame, 1)).sent, 1u);
    OdriveBringUp bring_up({3, kEndpoints}, options_);
    EXPECT_EQ(run(bring_up, bus, clock_).stage, Stage::ready) << stored_s;
  }
}

TEST_F(OdriveWatchdog, NothingIsAskedOfEndpointsOfAnotherVersion) {
  const auto refused = [this](odrive::OdriveEndpoints endpoints, std::uint32_t version, std::uint32_t wanted,
                              Setting setting) {
    ParameterOdrive driver;
    endpoints.torque_mode_limit = 0x193;
    mock::MockBus bus(clock_);
    bus.attach(driver);
    OdriveBringUp bring_up({3, endpoints}, options_);
    const StepResult result = run(bring_up, bus, clock_);
    EXPECT_EQ(result.failure, Failure::wrong_version);
    EXPECT_EQ(result.setting, setting);
    EXPECT_EQ(result.version, version);
    EXPECT_EQ(result.wanted_version, wanted);
    for (const CanFrame& frame : bus.sent()) {
      OdriveParameter parameter;
      EXPECT_NE(decode_parameter_request(3, frame, parameter), DecodeStatus::ok);
    }
  };
  for (const std::uint32_t other : {0u, 0x00060au, 0x00060cu, 0x00070bu}) {
    odrive::OdriveEndpoints endpoints = kEndpoints;
    endpoints.firmware_version = other;
    refused(endpoints, 0x00060b, other, Setting::odrive_firmware_version);
  }
  for (const std::uint32_t other : {0u, 0x04043bu, 0x05043au}) {
    odrive::OdriveEndpoints endpoints = kEndpoints;
    endpoints.hardware_version = other;
    refused(endpoints, 0x04043a, other, Setting::odrive_hardware_version);
  }
}

TEST_F(OdriveWatchdog, AnyVersionWillDoForADriverWithoutEndpoints) {
  options_.accept_missing_watchdog = true;
  ParameterOdrive driver;
  EXPECT_EQ(end(driver, {}).stage, Stage::ready);
  EXPECT_EQ(driver.writes, 0);
}

TEST_F(OdriveWatchdog, AFaultWhileNothingFeedsItIsNamed) {
  OdriveEmulator driver = odrive::make_emulator({3, kEndpoints});
  bus_.attach(driver);
  OdriveBringUp bring_up({3, kEndpoints}, options_);
  StepResult result;
  for (int tick = 0; tick < 4000 && result.stage < Stage::ready; ++tick) {
    if (driver.enabled()) driver.raise(DriverFault::over_voltage);
    result = run(bring_up, bus_, clock_, 1);
  }
  EXPECT_EQ(result.failure, Failure::driver_fault);
  EXPECT_EQ(result.driver_fault, DriverFault::over_voltage);
}

}  // namespace
}  // namespace stilt::hal::bring_up
