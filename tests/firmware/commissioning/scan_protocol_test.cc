#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "firmware/commissioning/scan.h"
#include "tests/firmware/commissioning/hanging_robot.h"

// Drivers of another protocol than the configuration has.
namespace stilt::commissioning {
namespace {

using testing::HangingRobot;
using Settings = std::vector<std::string>;

ScanResult scanned(HangingRobot& robot) {
  return scan(robot.configuration.hardware, robot.wanted(), robot.frame_buses(), robot, robot.stop);
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

Settings drivers(const std::string& protocol) {
  return {"hip_driver.protocol=" + protocol, "knee_driver.protocol=" + protocol,
          "hip_driver.accept_missing_watchdog=true", "knee_driver.accept_missing_watchdog=true"};
}

TEST(ScanProtocol, ADriverWhoseAnswerIsOfAnotherIsNamedWithTheKey) {
  HangingRobot cheetahs({.both = {}, .robot = drivers("mit_mini_cheetah"), .miswired = {}});
  const ScanResult result = scanned(cheetahs);
  EXPECT_FALSE(result.complete());
  const std::string text = to_text(result);
  EXPECT_TRUE(has(text,
                  "hip_L (mit_damiao 1): MISSING, no answer, but sends 7 bytes under 0x11: look at "
                  "hip_driver.protocol\n"))
      << text;
  EXPECT_TRUE(has(text, "sends 7 bytes under 0x14: look at knee_driver.protocol\n")) << text;
  const auto json = nlohmann::json::parse(to_json(result));
  EXPECT_EQ(json["buses"][1]["drivers"][1]["undecoded_reply"]["id"], 0x14);
  EXPECT_EQ(json["buses"][1]["drivers"][1]["undecoded_reply"]["length"], 7);

  HangingRobot damiao({.both = drivers("mit_mini_cheetah"), .robot = drivers("mit_damiao"), .miswired = {}});
  const std::string other = to_text(scanned(damiao));
  EXPECT_TRUE(has(other, "hip_R (mit_mini_cheetah 3): MISSING, no answer, but sends 8 bytes under 0x13: "))
      << other;
}

TEST(ScanProtocol, AnAnswerThatIsDecodedOrMissingIsNone) {
  for (const char* protocol : {"mit_damiao", "mit_ak", "mit_mini_cheetah", "odrive", "moteus"}) {
    HangingRobot robot({.both = drivers(protocol), .robot = {"hip_R.id=9"}, .miswired = {}});
    const ScanResult result = scanned(robot);
    EXPECT_FALSE(has(to_text(result), "bytes under")) << to_text(result);
    const auto json = nlohmann::json::parse(to_json(result));
    EXPECT_TRUE(json["buses"][1]["drivers"][0]["undecoded_reply"].is_null()) << json;
  }
}

/// As it comes from its vendor, an AK has 104. The configuration may name it, and the scan asks for it then.
TEST(ScanProtocol, AMissingJointIsNamedWithTheIdentifiersThatWereAsked) {
  HangingRobot robot({.both = drivers("mit_ak"), .robot = {"hip_R.id=104"}, .miswired = {}});
  const ScanResult result = scanned(robot);
  const std::string text = to_text(result);
  EXPECT_TRUE(has(text, "hip_R (mit_ak 3): MISSING, no answer\n")) << text;
  EXPECT_TRUE(has(text, "  looked for mit_ak 1 to 32: a driver with another identifier is not found\n"))
      << text;
  EXPECT_EQ(text.find("  looked for mit_ak"), text.rfind("  looked for mit_ak")) << "the left leg is whole\n"
                                                                                 << text;
  const auto json = nlohmann::json::parse(to_json(result));
  EXPECT_EQ(json["buses"][1]["asked_identifiers"].size(), 32u);

  Settings far = drivers("mit_ak");
  far.emplace_back("hip_R.id=104");
  HangingRobot named({.both = far, .robot = {"knee_R.id=105"}, .miswired = {}});
  const std::string other = to_text(scanned(named));
  EXPECT_TRUE(has(other, "hip_R (mit_ak 104): answers")) << other;
  EXPECT_TRUE(has(other, "  looked for mit_ak 1 to 32, 104: a driver")) << other;
}

}  // namespace
}  // namespace stilt::commissioning
