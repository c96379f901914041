#include "firmware/configuration/hardware.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "firmware/configuration/channel_text.h"
#include "firmware/configuration/configuration.h"
#include "hal/bus_load.h"

namespace stilt::configuration {
namespace {

using hal::protocol::BaseChannel;

/// All diagnostics of a file, "" when it is accepted.
std::string mistakes(std::string_view toml) {
  const Result result = parse(toml, "robot.toml");
  return result ? "" : to_string(result.error());
}

TEST(Hardware, TheShippedWiringIsValidAndNoBusIsOverloaded) {
  for (const char* robot : {"amber3m", "rabbit"}) {
    const Configuration configuration = load_robot(robot).value();
    EXPECT_EQ(configuration.hardware.robot, robot);
    const std::vector<std::string> names = bus_names(configuration.hardware);
    EXPECT_EQ(names, (std::vector<std::string>{"can0", "can1"})) << "never a bus that hides what it is";
    EXPECT_TRUE(hal::valid(robot_wiring(configuration.hardware), names.size()));
    for (std::size_t bus = 0; bus < names.size(); ++bus) {
      EXPECT_NE(bus_load(configuration.hardware, bus, 1000).verdict, hal::BusLoadVerdict::refused);
    }
  }
}

TEST(Hardware, AWiringIsReadKeyByKey) {
  const Result result = parse(
      "[hardware]\nbuses = \" vcan0 , loopback:right\"\n"
      "[hip_driver]\nprotocol = \"moteus\"\nratio = 6\nmoteus_kp_Nm_rev = 2000\n"
      "[knee_driver]\nprotocol = \"odrive\"\nodrive_watchdog_timeout_endpoint = 401\n"
      "[hip_R]\nid = 7\nreversed = false\noffset_rad = 0.5\nbus = 0\n"
      "[base_sensor]\nencoder_joint = 2\nencoder_number = 2\nencoder_reversed = true\npitch = \"none\"\n",
      "robot.toml");
  ASSERT_TRUE(result) << to_string(result.error());
  EXPECT_EQ(bus_names(result->hardware), (std::vector<std::string>{"vcan0", "loopback:right"}));
  const hal::RobotWiring wiring = robot_wiring(result->hardware);
  const auto& hip = std::get<hal::protocol::MoteusDriver>(wiring.joints[2].driver);
  EXPECT_EQ(hip.id, 7);
  EXPECT_EQ(hip.kp_Nm_rev, 2000);
  EXPECT_EQ(hip.extra_encoder, 2);
  EXPECT_EQ(wiring.joints[2].bus, 0);
  EXPECT_EQ(wiring.joints[2].ratio, 6);
  EXPECT_EQ(wiring.joints[2].direction, 1);
  EXPECT_EQ(wiring.joints[2].offset_rad, 0.5);
  EXPECT_EQ(std::get<hal::OdriveNode>(wiring.joints[1].driver).node, 2);
  EXPECT_EQ(odrive_endpoints(result->hardware, 1).watchdog_timeout, 401);
  EXPECT_EQ(wiring.pitch_encoder_joint, 2);
  EXPECT_EQ(wiring.pitch_direction, -1);
  EXPECT_EQ(wiring.channel_count, 2u) << "pitch rate and emergency stop are left";
}

TEST(Hardware, EveryContradictionOfTheWiringPointsAtItsLine) {
  EXPECT_EQ(mistakes("[hardware]\nbuses = \"can0\"\n"),
            "robot.toml:2:9: hip_R.bus = 1, but hardware.buses names 1 bus, numbered from 0\n"
            "robot.toml:2:9: knee_R.bus = 1, but hardware.buses names 1 bus, numbered from 0");
  EXPECT_EQ(mistakes("[knee_L]\nid = 1\n"),
            "robot.toml:2:6: knee_L and hip_L are on bus 0 with the same id 1; each driver needs its own");
  EXPECT_EQ(mistakes("[knee_L]\nid = 16\n"),
            "robot.toml:2:6: knee_L.id = 16: identifiers of this driver are 0 to 15");
  EXPECT_TRUE(mistakes("[base_sensor]\npitch = \"none\"\n").starts_with("robot.toml:2:9: nothing measures"));
  EXPECT_TRUE(mistakes("[base_sensor]\nencoder_joint = 1\n").starts_with("robot.toml:2:17: base_sensor."));
  EXPECT_TRUE(mistakes("[runtime]\nplanner_priority = 85\n")
                  .starts_with("robot.toml:2:20: runtime.planner_priority"));
}

TEST(Hardware, AMildReactionMustComeBeforeTheHardOne) {
  for (const char* key : {"missed_hold_ticks = 10", "hot_C = 95", "low_voltage_V = 60", "older_plan_s = 0.3",
                          "torque_loop_overrun_s = 0.02"}) {
    EXPECT_TRUE(mistakes(std::string("[supervisor]\n") + key + "\n").starts_with("robot.toml:2:")) << key;
  }
}

TEST(Hardware, TextsThatAreNotUnderstoodSayWhatWouldBeRight) {
  EXPECT_EQ(mistakes("[hardware]\nrobot = \"atlas\"\n"),
            "robot.toml:2:9: hardware.robot: there is no robot \"atlas\"; known robots are amber3m, rabbit");
  EXPECT_EQ(mistakes("[hardware]\nrobot = 3\n"),
            "robot.toml:2:9: hardware.robot must be text, the name of a robot, not a whole number");
  EXPECT_EQ(mistakes("[hardware]\nbuses = \"can0,can0\"\n"),
            "robot.toml:2:9: hardware.buses: names the bus can0 twice");
  EXPECT_NE(mistakes("[hardware]\nbuses = \"can0,\"\n"), "");
  EXPECT_NE(mistakes("[hardware]\nbuses = \"a,b,c,d,e\"\n"), "");
  EXPECT_NE(mistakes("[hardware]\nbuses = \"can\\\"0\"\n"), "");
  EXPECT_NE(mistakes("[base_sensor]\npitch = \"id 0x900 byte 0 bits 32\"\n").find("no frame holds"),
            std::string::npos);
}

TEST(Hardware, TravelOfAReversedJointIsThatOfItsShaft) {
  HardwareParameters hardware;
  hardware.knee.ratio = 2;
  hardware.joint[3].reversed = true;
  hardware.joint[3].offset_rad = 0.5;
  const hal::bring_up::Options options = bring_up_options(hardware, 3, 0.0, 2.4);
  // joint = -shaft / 2 + 0.5
  EXPECT_DOUBLE_EQ(options.minimum_angle_rad, -3.8);
  EXPECT_DOUBLE_EQ(options.maximum_angle_rad, 1.0);
  EXPECT_EQ(options.watchdog_s, hardware.driver_watchdog_s);
}

TEST(Channel, EveryWordSetsItsPart) {
  const auto parsed = parse_channel(
      "id 0x123456 extended byte 3 bit 2 bits 12 unsigned big scale -0.5 offset 1e2 invalid 0xfff",
      BaseChannel::pitch_rate_rad_s);
  ASSERT_TRUE(parsed && *parsed);
  const hal::protocol::ChannelRow& row = **parsed;
  EXPECT_EQ(row.id, 0x123456u);
  EXPECT_TRUE(row.extended);
  EXPECT_EQ(row.byte_offset, 3);
  EXPECT_EQ(row.bit_offset, 2);
  EXPECT_EQ(row.bits, 12);
  EXPECT_EQ(row.type, hal::protocol::RawType::unsigned_integer);
  EXPECT_EQ(row.order, hal::protocol::ByteOrder::big);
  EXPECT_EQ(row.scale, -0.5);
  EXPECT_EQ(row.offset, 100);
  EXPECT_TRUE(row.has_invalid);
  EXPECT_EQ(row.invalid_bits, 0xfffu);
  EXPECT_EQ(row.channel, BaseChannel::pitch_rate_rad_s);
}

TEST(Channel, NoneGivesNothingAndNonsenseIsNamed) {
  EXPECT_EQ(parse_channel("none", BaseChannel::pitch_rad), std::nullopt);
  for (const char* wrong : {"", "byte 0 bits 8", "id", "id x", "id 0x50 bits 40", "id 0x50 float bits 16",
                            "id 0x50 colour 3", "id 0x50 scale 0", "id 0x50 bits 300"}) {
    EXPECT_FALSE(parse_channel(wrong, BaseChannel::pitch_rad)) << wrong;
  }
  EXPECT_TRUE(parse_channel("id 0x50 colour 3", BaseChannel::pitch_rad)
                  .error()
                  .starts_with("\"colour 3\" is not understood"));
}

}  // namespace
}  // namespace stilt::configuration
