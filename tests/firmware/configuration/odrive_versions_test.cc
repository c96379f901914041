#include <gtest/gtest.h>

#include <string>

#include "firmware/configuration/configuration.h"
#include "firmware/configuration/version_text.h"

namespace stilt::configuration {
namespace {

std::string mistakes(std::string_view toml) {
  const Result result = parse(toml, "robot.toml");
  return result ? "" : to_string(result.error());
}

TEST(OdriveVersions, EndpointsOfAnOdriveAreThoseOfAVersion) {
  const std::string none = " = \"none\", but endpoints of the driver are given; set it to ";
  for (const std::string endpoint :
       {"watchdog_timeout", "enable_watchdog", "torque_mode_limit", "velocity_limit"}) {
    for (const bool odrive : {true, false}) {
      const std::string found =
          mistakes("[knee_driver]\nprotocol = \"" + std::string(odrive ? "odrive" : "moteus") +
                   "\"\nodrive_" + endpoint + "_endpoint = 401\n");
      for (const char* version : {"odrive_firmware_version", "odrive_hardware_version"}) {
        EXPECT_EQ(found.find(version + none) != std::string::npos, odrive) << endpoint << found;
      }
    }
  }
  EXPECT_EQ(mistakes("[hip_driver]\nprotocol = \"odrive\"\n").find("version"), std::string::npos)
      << "without endpoints any will do";
  EXPECT_EQ(
      mistakes("[hip_driver]\nodrive_firmware_version = \"0.6\"\n"),
      "robot.toml:2:27: hip_driver.odrive_firmware_version: \"0.6\" is no version; right are three numbers "
      "such as \"0.6.11\", or \"none\"");
}

TEST(OdriveVersions, AVersionIsThreeNumbersOfAByte) {
  EXPECT_EQ(parse_version("none"), 0u);
  EXPECT_EQ(parse_version("0.6.11"), 0x00060bu);
  EXPECT_EQ(parse_version("255.0.1"), 0xff0001u);
  for (const char* no_version : {"", "0.6", "0.6.", "0.6.11.", "0.6.11.1", "0.6.256", "0.6.-1", "0,6,11",
                                 "0.6.11-1", " 0.6.11", "v0.6.11", "0..6"}) {
    EXPECT_FALSE(parse_version(no_version)) << no_version;
  }
}

}  // namespace
}  // namespace stilt::configuration
