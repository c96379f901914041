#include "firmware/program/report.h"

#include <gtest/gtest.h>

namespace stilt::program {
namespace {

TEST(Report, ABusThatCannotCarryTheDriversIsRefused) {
  const configuration::Override one_bus[] = {{"hardware.buses=can0"}, {"hip_R.bus=0"}, {"knee_R.bus=0"}};
  const auto all_on_one = configuration::load_robot("amber3m", one_bus);
  ASSERT_TRUE(all_on_one) << configuration::to_string(all_on_one.error());
  const BusReport report = report_buses(*all_on_one);
  EXPECT_TRUE(report.refused);
  EXPECT_NE(report.text.find("bus can0: worst-case load 114 %"), std::string::npos) << report.text;
  EXPECT_FALSE(report_buses(*configuration::load_robot("amber3m")).refused);
}

TEST(Report, ARobotThatTheFramesCannotCarryIsRefused) {
  const configuration::Override short_range[] = {{"knee_driver.position_range_rad=0.5"}};
  const BusReport report = report_buses(*configuration::load_robot("amber3m", short_range));
  EXPECT_TRUE(report.refused);
  EXPECT_NE(report.text.find("knee_L: commands an angle"), std::string::npos) << report.text;
}

TEST(Report, ARobotThatCannotStandAsConfiguredIsRefused) {
  const configuration::Override too_high[] = {{"reference.base_height_m=0.9"}};
  const BusReport report = report_buses(*configuration::load_robot("amber3m", too_high));
  EXPECT_TRUE(report.refused);
  EXPECT_NE(report.text.find("\nreference.base_height_m = 0.9 "), std::string::npos) << report.text;
}

TEST(Report, TheRobotIsThatOfTheUrdf) {
  EXPECT_EQ(robot_text(*configuration::load_robot("rabbit")),
            "mass 32 kg, thigh 0.4 m, shin 0.4 m\n"
            "armature hip_L 0.83, knee_L 0.83, hip_R 0.83, knee_R 0.83 kg m^2\n"
            "hip height 0.735 m, 92 % of the straight leg\n");
}

// A file that was made for one robot and then given another keeps the stance of the first.
TEST(Report, AHipHeightThatMayBeOfAnotherRobotIsNamed) {
  const auto last_line = [](const char* robot, const char* height) {
    const configuration::Override other[] = {{height}};
    const std::string text = robot_text(*configuration::load_robot(robot, other));
    return text.substr(text.find("hip height"));
  };
  EXPECT_EQ(last_line("rabbit", "reference.base_height_m=0.79"),
            "hip height 0.79 m, 99 % of the straight leg: 80 to 97 % are usual; reference.base_height_m may "
            "be that of another robot\n");
  EXPECT_NE(last_line("amber3m", "reference.base_height_m=0.69").find("another robot"), std::string::npos);
  for (const char* height : {"reference.base_height_m=0.7", "reference.base_height_m=0.84"})
    EXPECT_EQ(last_line("amber3m", height).find("another robot"), std::string::npos) << height;
}

TEST(Report, DriversWithoutAWatchdogAreRefused) {
  const auto report_of = [](const std::string& protocol, const std::string& setting) {
    const configuration::Override changes[] = {{"knee_driver.protocol=" + protocol},
                                               {"knee_driver.position_range_rad=12.56"},
                                               {"knee_driver." + setting}};
    return report_buses(configuration::load_robot("amber3m", changes).value());
  };
  for (const char* protocol : {"mit_ak", "mit_mini_cheetah", "ak_v3"}) {
    const BusReport report = report_of(protocol, "accept_missing_watchdog=false");
    EXPECT_TRUE(report.refused) << protocol;
    EXPECT_NE(report.text.find("\nknee_driver.accept_missing_watchdog is false, and must be true: it has no "
                               "watchdog that can be read\n"),
              std::string::npos)
        << report.text;
    EXPECT_FALSE(report_of(protocol, "accept_missing_watchdog=true").refused) << protocol;
  }
  const BusReport odrive = report_of("odrive", "accept_missing_watchdog=false");
  EXPECT_TRUE(odrive.refused);
  EXPECT_NE(odrive.text.find("\nknee_driver.odrive_enable_watchdog_endpoint is 0, and must be the id of "),
            std::string::npos)
      << odrive.text;
  EXPECT_FALSE(report_of("odrive", "accept_missing_watchdog=true").refused);
  EXPECT_FALSE(report_of("mit_damiao", "accept_missing_watchdog=false").refused) << "it has one";
}

// A sensor at a serial port is on neither bus.
TEST(Report, BusesThatAScanCannotTellApartAreNamed) {
  std::vector<configuration::Override> changes = {{"hip_R.id=1"},
                                                  {"hip_R.reply_id=17"},
                                                  {"knee_R.id=2"},
                                                  {"knee_R.reply_id=18"},
                                                  {"torso_sensor.device=vectornav"},
                                                  {"torso_sensor.emergency_stop_released=none"}};
  const auto text_with = [&](const std::vector<configuration::Override>& more) {
    std::vector<configuration::Override> all = changes;
    all.insert(all.end(), more.begin(), more.end());
    const auto configuration = configuration::load_robot("amber3m", all);
    EXPECT_TRUE(configuration) << configuration::to_string(configuration.error());
    const BusReport report = report_buses(*configuration);
    EXPECT_FALSE(report.refused) << report.text;
    return report.text;
  };
  const std::string sentence =
      "\nhip_L and knee_L on can0 have the same identifiers as hip_R and knee_R on can1: exchanged adapters "
      "would not be noticed; give each driver its own identifier\n";
  EXPECT_NE(text_with({}).find(sentence), std::string::npos) << text_with({});
  EXPECT_EQ(text_with({{"knee_R.id=4"}}).find("exchanged"), std::string::npos);
  EXPECT_EQ(text_with({{"hip_R.reply_id=19"}}).find("exchanged"), std::string::npos);
  EXPECT_EQ(text_with({{"torso_sensor.device=channels"}}).find("exchanged"), std::string::npos)
      << "frames of the sensor are on can0";
}

TEST(Report, ACanInterfaceRequiresARealTimeMachineAndSimulatedBusesDoNot) {
  const auto requires_with = [](const std::string& buses, const std::string& setting) {
    const configuration::Override overrides[] = {{"hardware.buses=" + buses}, {setting}};
    return requires_realtime(*configuration::load_robot("amber3m", overrides));
  };
  const std::string as_shipped = "runtime.require_realtime_always=false";
  EXPECT_TRUE(requires_with("can0,can1", as_shipped));
  EXPECT_TRUE(requires_with("can0,loopback:right", as_shipped));
  EXPECT_TRUE(requires_with("slcan0,vcan1", as_shipped));
  EXPECT_TRUE(requires_with("fdcanusb:/dev/ttyACM0,fdcanusb:/dev/ttyACM1", as_shipped));
  EXPECT_FALSE(requires_with("loopback:left,loopback:right", as_shipped));
  EXPECT_FALSE(requires_with("vcan0,loopback:right", as_shipped));
  EXPECT_FALSE(requires_with("can0,can1", "runtime.require_realtime=false"));
  EXPECT_TRUE(requires_with("loopback:left,vcan1", "runtime.require_realtime_always=true"));
}

TEST(Report, TheMachineIsDescribedWithWhatIsLacking) {
  realtime::Capability capability;
  capability.kernel = "6.1-rt";
  capability.cores = 4;
  capability.memory_locked = capability.priority_allowed = true;
  EXPECT_EQ(
      describe(capability),
      "kernel 6.1-rt, 4 processors, memory locked, priority granted, idle states as they are (not asked "
      "for)\nreal time\n");
  capability.torque_core = 1;
  EXPECT_NE(describe(capability).find("4 processors, processor 1 shared with other programs,"),
            std::string::npos);
  capability.core_isolated = true;
  EXPECT_NE(describe(capability).find("4 processors, processor 1 isolated,"), std::string::npos);
  capability.lacking = {"this", "that"};
  EXPECT_NE(describe(capability).find("not real time: this; that"), std::string::npos);
}

}  // namespace
}  // namespace stilt::program
