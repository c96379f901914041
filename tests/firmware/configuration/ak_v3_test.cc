#include <gtest/gtest.h>

#include <string>

#include "firmware/configuration/configuration.h"
#include "firmware/configuration/hardware.h"

// Drivers of an AK of version 3 in the configuration.
namespace stilt::configuration {
namespace {

/// The configuration with such drivers everywhere, and more lines of other sections.
Result with_ak(const std::string& driver_lines, const std::string& more = "") {
  std::string toml;
  for (const char* section : {"[hip_driver]", "[knee_driver]"}) {
    toml.append(section).append("\nprotocol = \"ak_v3\"\n").append(driver_lines);
  }
  return parse(toml + more, "robot.toml");
}

/// All diagnostics, "" when it is accepted.
std::string mistakes(const std::string& driver_lines, const std::string& more = "") {
  const Result result = with_ak(driver_lines, more);
  return result ? "" : to_string(result.error());
}

TEST(AkV3, WorksWithTheShippedIdentifiersAndGains) {
  EXPECT_EQ(mistakes("position_range_rad = 12.56\n"), "");
}

TEST(AkV3, RangesThatNoSuchMotorHasAreRefused) {
  const std::string found = mistakes("");
  EXPECT_NE(
      found.find("hip_driver.position_range_rad = 3.2, but that of every AK of version 3 is 12.56; set it "
                 "to that"),
      std::string::npos)
      << found;
  EXPECT_NE(found.find("knee_driver.position_range_rad = 3.2"), std::string::npos) << found;
  EXPECT_EQ(mistakes("position_range_rad = 12.5\n"), "") << "some documents have that";
  EXPECT_NE(mistakes("position_range_rad = 12.56\nkp_range_Nm_rad = 250\n")
                .find("kp_range_Nm_rad = 250, but that of every AK of version 3 is 500"),
            std::string::npos);
  EXPECT_NE(mistakes("position_range_rad = 12.56\nkd_range_Nms_rad = 50\n")
                .find("kd_range_Nms_rad = 50, but that of every AK of version 3 is 5"),
            std::string::npos);
}

TEST(AkV3, ReportsAreDueByItsRate) {
  HardwareParameters hardware;
  hardware.knee.protocol = DriverProtocol::ak_v3;
  const hal::RobotWiring wiring = robot_wiring(hardware, 1000);
  EXPECT_EQ(wiring.joints[0].report_period_ticks, 1) << "a Damiao answers each command";
  EXPECT_EQ(wiring.joints[1].report_period_ticks, 3) << "every 2 ms, by another clock";
  EXPECT_EQ(wiring.channel_period_ticks, 2);
  hardware.knee.ak_v3_status_rate_hz = 300;
  EXPECT_EQ(robot_wiring(hardware, 1000).joints[3].report_period_ticks, 5);
  EXPECT_EQ(robot_wiring(hardware, 250).joints[3].report_period_ticks, 2);
}

TEST(AkV3, MustReportBeforeItsReadingsAreOld) {
  const auto at = [](const char* rate, const char* more) {
    return mistakes(std::string("position_range_rad = 12.56\nak_v3_status_rate_hz = ") + rate + "\n", more);
  };
  EXPECT_EQ(at("500", ""), "") << "3 ms";
  const std::string found = at("400", "");
  EXPECT_NE(
      found.find("hip_driver.ak_v3_status_rate_hz = 400: readings get a period and a tick old, 0.0035 s, and "
                 "hardware.longest_reply_lag_s = 0.003; let the driver report more often, or allow for that"),
      std::string::npos)
      << found;
  EXPECT_NE(found.find("knee_driver.ak_v3_status_rate_hz = 400"), std::string::npos);
  EXPECT_EQ(at("400", "[hardware]\nlongest_reply_lag_s = 0.0035\n"), "");
  EXPECT_NE(at("500", "[timing]\ntorque_rate_hz = 800\n"), "") << "ticks count, too";
}

TEST(AkV3, HasTheNumbersOfTheFile) {
  const Result result = with_ak(
      "position_range_rad = 12.5\nvelocity_range_rad_s = 28\ntorque_range_Nm = 54\n"
      "ak_v3_status_rate_hz = 400\nak_v3_position_frames = true\nak_v3_pole_pairs = 14\n"
      "ak_v3_gear_ratio = 6\nak_v3_torque_constant_Nm_A = -0.7\n",
      "[hardware]\nlongest_reply_lag_s = 0.0035\n[knee_R]\nid = 104\n");
  ASSERT_TRUE(result) << to_string(result.error());
  const auto driver = std::get<hal::ak::AkDriver>(robot_wiring(result->hardware).joints[3].driver);
  EXPECT_EQ(driver.id, 104);
  EXPECT_EQ(driver.position_rad, 12.5);
  EXPECT_EQ(driver.velocity_rad_s, 28);
  EXPECT_EQ(driver.torque_Nm, 54);
  EXPECT_EQ(driver.kp_Nm_rad, 500);
  EXPECT_EQ(driver.kd_Nms_rad, 5);
  EXPECT_EQ(driver.status_rate_hz, 400);
  EXPECT_TRUE(driver.position_frames);
  EXPECT_EQ(driver.pole_pairs, 14);
  EXPECT_EQ(driver.gear_ratio, 6);
  EXPECT_EQ(driver.torque_constant_Nm_A, -0.7);
}

}  // namespace
}  // namespace stilt::configuration
