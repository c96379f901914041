#include "firmware/commissioning/scan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "firmware/commissioning/watch.h"
#include "tests/firmware/commissioning/hanging_robot.h"

namespace stilt::commissioning {
namespace {

using testing::HangingRobot;
using testing::kAkV3;
using testing::kOdriveWithWatchdog;

const std::vector<std::string> kMoteus = {"hip_driver.protocol=moteus", "knee_driver.protocol=moteus"};
const std::vector<std::string> kOdrive = {"hip_driver.protocol=odrive", "knee_driver.protocol=odrive",
                                          "hip_driver.accept_missing_watchdog=true",
                                          "knee_driver.accept_missing_watchdog=true"};
const std::vector<std::string> kAk = {"hip_driver.protocol=mit_ak", "knee_driver.protocol=mit_ak",
                                      "hip_driver.accept_missing_watchdog=true",
                                      "knee_driver.accept_missing_watchdog=true"};

std::vector<std::string> joined(std::vector<std::string> first, const std::vector<std::string>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

ScanResult scanned(HangingRobot& robot) {
  return scan(robot.configuration.hardware, robot.wanted(), robot.frame_buses(), robot, robot.stop);
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Scan, FindsEveryDriverOfTheConfigurationWithWhatItReports) {
  HangingRobot robot;
  const ScanResult result = scanned(robot);
  EXPECT_TRUE(result.complete()) << to_text(result);
  ASSERT_EQ(result.buses.size(), 2u);
  for (const ScannedBus& bus : result.buses) {
    ASSERT_EQ(bus.expected.size(), 2u);
    EXPECT_TRUE(bus.unexpected.empty());
    EXPECT_TRUE(bus.unknown.empty());
    for (const ScannedNode& node : bus.expected) {
      EXPECT_EQ(node.protocol, "mit_damiao");
      EXPECT_FALSE(node.firmware.empty());
      EXPECT_EQ(node.found.reading.driver_temperature_C, 30.0);
      EXPECT_EQ(node.found.reading.state, hal::DriverState::idle);
    }
  }
  ASSERT_EQ(result.buses[0].torso_sensor.size(), 1u);
  EXPECT_NEAR(result.buses[0].torso_sensor[0].rate_hz, 500.0, 10.0);
}

TEST(Scan, FindsDriversOfEveryProtocol) {
  for (const std::vector<std::string>& settings : {kMoteus, kOdrive, kAk, kAkV3}) {
    HangingRobot robot({.both = settings, .robot = {}, .miswired = {}});
    const ScanResult result = scanned(robot);
    EXPECT_TRUE(result.complete()) << to_text(result);
    for (const ScannedBus& bus : result.buses) EXPECT_TRUE(bus.unexpected.empty()) << to_text(result);
  }
}

TEST(Scan, ReportsSupplyAndFirmwareAsTheVendorsWriteThem) {
  HangingRobot moteus({.both = kMoteus, .robot = {}, .miswired = {}});
  const ScannedNode hip = scanned(moteus).buses[0].expected[0];
  EXPECT_EQ(hip.found.reading.supply_V, 48.0);
  EXPECT_EQ(std::count(hip.firmware.begin(), hip.firmware.end(), '.'), 2);
}

TEST(Scan, EnablesNoDriverAndMovesNothing) {
  for (const std::vector<std::string>& settings : {std::vector<std::string>{}, kMoteus, kOdrive, kAk}) {
    HangingRobot robot({.both = settings, .robot = {}, .miswired = {}});
    static_cast<void>(scanned(robot));
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      EXPECT_FALSE(robot.robot.drivers().driver(joint).enabled());
      EXPECT_EQ(robot.peak_torque_Nm(joint), 0.0);
    }
    EXPECT_GT(robot.buses[0].sent.size(), 4u);
    for (const testing::DirectBus& bus : robot.buses) {
      for (const hal::CanFrame& frame : bus.sent) {
        EXPECT_FALSE(frame.length == 8 && !frame.fd && !frame.remote && frame.data[7] == 0xfc)
            << "an MIT frame that turns the motor on";
      }
    }
  }
}

TEST(Scan, SendsNothingToAnAkOfVersionThree) {
  HangingRobot robot({.both = kAkV3, .robot = {"hip_R.id=9"}, .miswired = {}});
  static_cast<void>(scanned(robot));
  for (const testing::DirectBus& bus : robot.buses) EXPECT_TRUE(bus.sent.empty());
}

TEST(Scan, NamesAnAkOfVersionThreeThatReportsTooSeldom) {
  HangingRobot robot(
      {.both = joined(kAkV3, {"hip_driver.ak_v3_position_frames=true"}),
       .robot = {"hip_driver.ak_v3_status_rate_hz=200", "hip_driver.ak_v3_position_frames=false",
                 "hardware.longest_reply_lag_s=0.01"},
       .miswired = {}});
  const std::string text = to_text(scanned(robot));
  EXPECT_TRUE(has(text, "SETTING CAN feedback rate, Hz, is 200, and must be 500")) << text;
  EXPECT_TRUE(has(text, "SETTING rate of position frames 0x2A, Hz, is silent, and must be 500")) << text;
}

TEST(Scan, NamesADriverThatIsMissingAndOneThatIsNotConfigured) {
  for (const std::vector<std::string>& settings :
       {std::vector<std::string>{}, kMoteus, kOdrive, kAk, kAkV3}) {
    HangingRobot robot({.both = settings, .robot = {"hip_R.id=9"}, .miswired = {}});
    const ScanResult result = scanned(robot);
    EXPECT_FALSE(result.complete());
    const ScannedBus& right = result.buses[1];
    EXPECT_FALSE(right.expected[0].found.answered);
    EXPECT_TRUE(right.expected[1].good());
    ASSERT_EQ(right.unexpected.size(), 1u) << to_text(result);
    EXPECT_EQ(right.unexpected[0].id, 9);
    EXPECT_TRUE(has(to_text(result), "hip_R (" + right.unexpected[0].protocol + " 3): MISSING"));
    EXPECT_TRUE(has(to_text(result), "UNEXPECTED: " + right.unexpected[0].protocol + " 9"));
  }
}

TEST(Scan, NamesADriverThatAnswersWithAnotherIdentifier) {
  HangingRobot robot({.both = {}, .robot = {"knee_L.reply_id=0"}, .miswired = {}});
  const ScanResult result = scanned(robot);
  EXPECT_FALSE(result.complete());
  EXPECT_TRUE(result.buses[0].expected[1].wrong_reply_id());
  EXPECT_TRUE(has(to_text(result), "with identifier 0x0 where knee_L.reply_id is 0x12")) << to_text(result);
}

/// By its firmware an AK answers with its own identifier.
const std::vector<std::string> kOwnReplyIds = {"hip_L.reply_id=1", "knee_L.reply_id=2", "hip_R.reply_id=3",
                                               "knee_R.reply_id=4"};

TEST(Scan, FindsAnAkThatAnswersWithItsOwnIdentifier) {
  HangingRobot robot({.both = joined(kAk, kOwnReplyIds), .robot = {}, .miswired = {}});
  const ScanResult result = scanned(robot);
  EXPECT_TRUE(result.complete()) << to_text(result);
}

TEST(Scan, NamesAnAkThatAnswersWithItsOwnIdentifierAgainstTheConfiguration) {
  HangingRobot robot({.both = kAk, .robot = kOwnReplyIds, .miswired = {}});
  const ScanResult result = scanned(robot);
  EXPECT_FALSE(result.complete());
  const std::string text = to_text(result);
  EXPECT_TRUE(has(text, "with identifier 0x1 where hip_L.reply_id is 0x11")) << text;
  EXPECT_TRUE(has(text, "with identifier 0x4 where knee_R.reply_id is 0x14")) << text;
}

TEST(Scan, NamesAllSettingsOfAllDriversThatDiffer) {
  HangingRobot robot({.both = {},
                      .robot = {"hip_driver.torque_range_Nm=60", "hip_driver.reply_torque_range_Nm=60",
                                "hip_driver.position_range_rad=12.5", "knee_driver.velocity_range_rad_s=45"},
                      .miswired = {}});
  const ScanResult result = scanned(robot);
  EXPECT_FALSE(result.complete());
  const std::string text = to_text(result);
  for (const ScannedBus& bus : result.buses) {
    EXPECT_EQ(std::ranges::count(bus.expected[0].settings, false, &hal::ReadSetting::right), 2) << text;
    EXPECT_EQ(std::ranges::count(bus.expected[1].settings, false, &hal::ReadSetting::right), 1) << text;
  }
  EXPECT_TRUE(has(text, "SETTING PMAX is 12.5, and must be 3.2")) << text;
  const nlohmann::json json = nlohmann::json::parse(to_json(result));
  EXPECT_EQ(json.at("buses").at(1).at("drivers").at(1).at("settings").at(2).at("name"), "VMAX") << json;
}

TEST(Scan, ReadsTheSettingsOfAMoteusThatDiffer) {
  HangingRobot robot({.both = kMoteus,
                      .robot = {"knee_driver.moteus_kp_Nm_rev=700", "knee_driver.moteus_kd_Nms_rev=35"},
                      .miswired = {}});
  const std::string text = to_text(scanned(robot));
  EXPECT_TRUE(has(text, "SETTING servo.pid_position.kp is 700.000000, and must be 800")) << text;
  EXPECT_TRUE(has(text, "SETTING servo.pid_position.kd is 35.000000, and must be 40")) << text;
}

/// Bring-up refuses these drivers, and would be the first to name the key.
TEST(Scan, NamesTheKeysOfADriverWithoutAWatchdog) {
  for (const char* protocol : {"mit_ak", "mit_mini_cheetah", "ak_v3"}) {
    HangingRobot robot({.both = joined(kAkV3, {std::string("knee_driver.protocol=") + protocol,
                                               "knee_driver.accept_missing_watchdog=false"}),
                        .robot = {},
                        .miswired = {}});
    const ScanResult result = scanned(robot);
    const std::string text = to_text(result);
    EXPECT_FALSE(result.complete()) << protocol;
    EXPECT_TRUE(result.buses[1].expected[0].good()) << text;
    EXPECT_TRUE(has(text,
                    "    SETTING knee_driver.accept_missing_watchdog is false, and must be true: it has no "
                    "watchdog that can be read\n"))
        << text;
  }
}

TEST(Scan, NamesTheEndpointsOfAnOdriveWithoutAWatchdog) {
  const std::vector<std::string> strict = joined(kOdrive, {"hip_driver.accept_missing_watchdog=false"});
  HangingRobot unknown({.both = strict, .robot = {}, .miswired = {}});
  const std::string text = to_text(scanned(unknown));
  for (const char* parameter : {"watchdog_timeout", "enable_watchdog"}) {
    EXPECT_TRUE(
        has(text, std::string("    SETTING hip_driver.odrive_") + parameter +
                      "_endpoint is 0, and must be the id of axis0.config." + parameter +
                      " in flat_endpoints.json of its firmware, or accept_missing_watchdog must be true\n"))
        << text;
  }
  EXPECT_FALSE(has(text, "knee_driver.")) << text;
  HangingRobot half({.both = joined(strict, {"hip_driver.odrive_watchdog_timeout_endpoint=401",
                                             "hip_driver.odrive_firmware_version=0.6.11",
                                             "hip_driver.odrive_hardware_version=4.4.58"}),
                     .robot = {},
                     .miswired = {}});
  const std::string other = to_text(scanned(half));
  EXPECT_FALSE(has(other, "odrive_watchdog_timeout_endpoint")) << other;
  EXPECT_TRUE(has(other, "odrive_enable_watchdog_endpoint is 0")) << other;
}

/// A session, and what another program does not receive of it.
void watch_for_a_while(HangingRobot& robot) {
  {
    Session session = robot.session();
    const auto done = watch(session, 0.1, [](const WatchSample&) {});
    ASSERT_TRUE(done) << done.error();
  }
  static_cast<void>(robot.sleep_until(robot.now_ns() + 10'000'000));
  std::array<hal::CanFrame, hal::kMaximumBatch> late;
  for (hal::FrameBus* bus : robot.frame_buses()) {
    while (bus->receive(late).received > 0) {
    }
  }
}

/// The watchdog that a session switched on has expired since.
TEST(Scan, IsCompleteBeforeAndAfterASessionWithEveryProtocol) {
  for (const std::vector<std::string>& settings :
       {std::vector<std::string>{}, kMoteus, kOdrive, kOdriveWithWatchdog, kAk, kAkV3}) {
    HangingRobot robot({.both = settings, .robot = {}, .miswired = {}});
    EXPECT_TRUE(scanned(robot).complete());
    watch_for_a_while(robot);
    const ScanResult result = scanned(robot);
    EXPECT_TRUE(result.complete()) << to_text(result);
    const bool ended = settings == kOdriveWithWatchdog;
    EXPECT_EQ(has(to_text(result), "idle: its watchdog ended the last session\n"), ended) << to_text(result);
    EXPECT_EQ(has(to_json(result), "\"watchdog_ended\": true"), ended);
  }
}

TEST(Scan, NamesAFaultOfAnOdriveBesideItsExpiredWatchdog) {
  HangingRobot robot({.both = kOdriveWithWatchdog, .robot = {}, .miswired = {}});
  watch_for_a_while(robot);
  robot.robot.drivers().driver(2).raise(hal::DriverFault::over_voltage);
  const ScanResult result = scanned(robot);
  EXPECT_FALSE(result.complete());
  EXPECT_FALSE(result.buses[1].expected[0].good()) << to_text(result);
  EXPECT_TRUE(result.buses[1].expected[1].good()) << to_text(result);
}

TEST(Scan, NamesAnOdriveOfAnotherVersionThanItsEndpoints) {
  HangingRobot robot(
      {.both = kOdriveWithWatchdog, .robot = {"hip_driver.odrive_firmware_version=0.6.12"}, .miswired = {}});
  const std::string text = to_text(scanned(robot));
  EXPECT_TRUE(has(text,
                  "    SETTING firmware version is 0.6.12, and must be 0.6.11, odrive_firmware_version; or "
                  "that key and all endpoints must be its own\n"))
      << text;
}

/// An AK whose firmware is silent while its motor is off.
TEST(Scan, NamesTheKeyAlsoOfADriverThatIsSilent) {
  HangingRobot robot({.both = joined(kAk, {"hip_driver.accept_missing_watchdog=false"}),
                      .robot = {"hip_R.id=9"},
                      .miswired = {}});
  const std::string text = to_text(scanned(robot));
  EXPECT_TRUE(has(text, "MISSING, no answer\n    SETTING hip_driver.accept_missing_watchdog is false"))
      << text;
}

TEST(Scan, AnEncoderOnCanopenThatIsMissingOrMuteIsNotComplete) {
  const std::vector<std::string> encoder = {"torso_sensor.device=canopen_encoder"};
  HangingRobot whole({.both = encoder, .robot = {}, .miswired = {}});
  EXPECT_TRUE(scanned(whole).complete()) << to_text(scanned(whole));
  HangingRobot missing({.both = encoder, .robot = {"torso_sensor.encoder_node=9"}, .miswired = {}});
  EXPECT_FALSE(scanned(missing).complete());
  HangingRobot mute({.both = encoder, .robot = {}, .miswired = {}});
  mute.lost_id = 0x1a0;  // its positions
  EXPECT_FALSE(scanned(mute).complete());
}

TEST(Scan, ATroubleOfTheTorsoSensorIsNotComplete) {
  HangingRobot robot;
  ScanResult result = scanned(robot);
  ASSERT_TRUE(result.complete());
  result.serial_sensor_trouble = "torso sensor: silent";
  EXPECT_FALSE(result.complete());
  EXPECT_TRUE(has(to_text(result), "torso sensor: silent\nnot complete")) << to_text(result);
  result.serial_sensor_trouble.clear();
  result.buses[0].torso_trouble = "wrong steps";
  EXPECT_FALSE(result.complete());
  result.buses[0].torso_trouble.clear();
  result.buses[0].torso_sensor[0].rate_hz = 0;
  result.buses[0].torso_sensor[0].expected_hz = 0;
  EXPECT_FALSE(result.complete());
}

TEST(Scan, NamesExchangedBuses) {
  HangingRobot robot(
      {.both = {}, .robot = {"hip_L.bus=1", "knee_L.bus=1", "hip_R.bus=0", "knee_R.bus=0"}, .miswired = {}});
  const std::string text = to_text(scanned(robot));
  EXPECT_TRUE(has(text, "exchanged buses: can0 and can1")) << text;
  EXPECT_TRUE(has(text, "hip_R has this identifier on can1, where it is missing")) << text;
}

TEST(Scan, NamesFramesThatTheConfigurationDoesNotKnow) {
  HangingRobot robot({.both = {},
                      .robot = {"torso_sensor.pitch=id 0x160 byte 0 bits 24 signed little scale 1e-6",
                                "torso_sensor.pitch_rate=id 0x160 byte 3 bits 16 signed little scale 5e-4",
                                "torso_sensor.emergency_stop_released=none"},
                      .miswired = {}});
  const ScanResult result = scanned(robot);
  EXPECT_FALSE(result.complete());
  ASSERT_EQ(result.buses[0].unknown.size(), 1u);
  EXPECT_EQ(result.buses[0].unknown[0].id, 0x160u);
  EXPECT_TRUE(has(to_text(result), "torso sensor: MISSING, identifier 0x150"));
}

TEST(Scan, AnUnknownDriverOnTheBusIsNotComplete) {
  HangingRobot robot;
  const ScanResult whole = scanned(robot);
  ASSERT_TRUE(whole.complete()) << to_text(whole);
  ScanResult with_driver = whole;
  with_driver.buses[1].unexpected.push_back(whole.buses[1].expected[0]);
  with_driver.buses[1].unexpected[0].joint.reset();
  EXPECT_FALSE(with_driver.complete()) << to_text(with_driver);
  ScanResult with_frames = whole;
  with_frames.buses[0].unknown.push_back({.id = 0x7f, .rate_hz = 1000});  // another commander, perhaps
  EXPECT_FALSE(with_frames.complete()) << to_text(with_frames);
}

TEST(Scan, ASlowTorsoSensorIsNotComplete) {
  HangingRobot robot({.both = {}, .robot = {"torso_sensor.rate_hz=100"}, .miswired = {}});
  const ScanResult result = scanned(robot);
  EXPECT_FALSE(result.complete()) << to_text(result);
}

TEST(Scan, AFastTorsoSensorIsNotComplete) {
  HangingRobot robot({.both = {}, .robot = {"torso_sensor.rate_hz=1000"}, .miswired = {}});
  const ScanResult result = scanned(robot);
  EXPECT_FALSE(result.complete());
  EXPECT_TRUE(has(to_text(result),
                  "torso sensor: TOO OFTEN, identifier 0x150, 1000 per second where torso_sensor.rate_hz is "
                  "500\n"))
      << to_text(result);
}

TEST(Scan, AFaultOfADriverIsNotComplete) {
  HangingRobot robot;
  const_cast<hal::EmulatedDriver&>(robot.robot.drivers().driver(1)).raise(hal::DriverFault::over_voltage);
  const ScanResult result = scanned(robot);
  EXPECT_FALSE(result.complete());
  EXPECT_TRUE(has(to_text(result), "over voltage")) << to_text(result);
}

TEST(Scan, AsksNoOtherIdentifiersWhereProtocolsAreMixed) {
  HangingRobot robot({.both = {"hip_driver.protocol=odrive", "hip_driver.accept_missing_watchdog=true"},
                      .robot = {},
                      .miswired = {}});
  const ScanResult result = scanned(robot);
  EXPECT_TRUE(result.complete()) << to_text(result);
  EXPECT_FALSE(result.buses[0].asked_others);
}

TEST(Scan, JsonHasEveryDriver) {
  HangingRobot robot;
  const auto json = nlohmann::json::parse(to_json(scanned(robot)));
  EXPECT_TRUE(json["complete"]);
  EXPECT_TRUE(json["good"]);
  EXPECT_EQ(json["buses"][1]["drivers"][0]["joint"], "hip_R");
  EXPECT_EQ(json["buses"][1]["drivers"][0]["mode"], "idle");
  EXPECT_TRUE(json["buses"][0]["drivers"][0]["supply_V"].is_null()) << "a Damiao does not report it";
}

}  // namespace
}  // namespace stilt::commissioning
