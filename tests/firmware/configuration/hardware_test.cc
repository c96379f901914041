#include "firmware/configuration/hardware.h"

#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "firmware/configuration/configuration.h"
#include "hal/can/bus_load.h"
#include "tests/firmware/configuration/with_drivers.h"

namespace stilt::configuration {
namespace {

/// All diagnostics of a file, "" when it is accepted.
std::string mistakes(std::string_view toml) {
  const Result result = parse(toml, "robot.toml");
  return result ? "" : to_string(result.error());
}

TEST(Hardware, TheShippedWiringIsValidAndNoBusIsLoadedMuch) {
  for (const char* robot : {"amber3m", "rabbit"}) {
    const Configuration configuration = load_robot(robot).value();
    ASSERT_EQ(configuration.timing.torque_rate_hz, 1000);
    EXPECT_EQ(configuration.hardware.robot, robot);
    const std::vector<std::string> names = bus_names(configuration.hardware);
    EXPECT_EQ(names, (std::vector<std::string>{"can0", "can1"})) << "never a bus that hides what it is";
    EXPECT_TRUE(hal::valid(robot_wiring(configuration.hardware), names.size()));
    for (std::size_t bus = 0; bus < names.size(); ++bus) {
      EXPECT_EQ(bus_load(configuration.hardware, bus, 1000).verdict, hal::BusLoadVerdict::fine);
    }
  }
}

TEST(Hardware, AWiringIsReadKeyByKey) {
  const Result result = parse(
      "[hardware]\nbuses = \" vcan0 , loopback:right\"\n"
      "[hip_driver]\nprotocol = \"moteus\"\nratio = 6\nmoteus_kp_Nm_rev = 2000\n"
      "[knee_driver]\nprotocol = \"odrive\"\nodrive_watchdog_timeout_endpoint = 401\n"
      "odrive_firmware_version = \"0.6.11\"\nodrive_hardware_version = \"4.4.58\"\n"
      "[hip_R]\nid = 7\nreversed = false\noffset_rad = 0.5\nbus = 0\n"
      "[torso_sensor]\nencoder_joint = 2\nencoder_number = 2\nencoder_reversed = true\npitch = \"none\"\n",
      "robot.toml");
  ASSERT_TRUE(result) << to_string(result.error());
  EXPECT_EQ(bus_names(result->hardware), (std::vector<std::string>{"vcan0", "loopback:right"}));
  const hal::RobotWiring wiring = robot_wiring(result->hardware);
  const auto& hip = std::get<hal::moteus::MoteusDriver>(wiring.joints[2].driver);
  EXPECT_EQ(hip.id, 7);
  EXPECT_EQ(hip.kp_Nm_rev, 2000);
  EXPECT_EQ(hip.extra_encoder, 2);
  EXPECT_EQ(wiring.joints[2].bus, 0);
  EXPECT_EQ(wiring.joints[2].ratio, 6);
  EXPECT_EQ(wiring.joints[2].direction, 1);
  EXPECT_EQ(wiring.joints[2].offset_rad, 0.5);
  const auto& odrive = std::get<hal::odrive::OdriveDriver>(wiring.joints[1].driver);
  EXPECT_EQ(odrive.node, 2);
  EXPECT_EQ(odrive.endpoints.watchdog_timeout, 401);
  EXPECT_EQ(odrive.endpoints.firmware_version, 0x00060bu);
  EXPECT_EQ(odrive.endpoints.hardware_version, 0x04043au);
  EXPECT_EQ(wiring.pitch_encoder_joint, 2);
  EXPECT_EQ(wiring.pitch_direction, -1);
  EXPECT_EQ(wiring.channel_count, 1u) << "the emergency stop is left";
}

TEST(Hardware, EveryContradictionOfTheWiringPointsAtItsLine) {
  EXPECT_EQ(mistakes("[hardware]\nbuses = \"can0\"\n"),
            "robot.toml:2:9: hip_R.bus = 1, but hardware.buses names 1 bus, numbered from 0; name one more, "
            "or give "
            "--bus once for each\n"
            "robot.toml:2:9: knee_R.bus = 1, but hardware.buses names 1 bus, numbered from 0; name one more, "
            "or give "
            "--bus once for each");
  EXPECT_EQ(mistakes("[knee_L]\nid = 1\n"),
            "robot.toml:2:6: knee_L and hip_L are on bus 0 and their frames collide: identifier 0x1 against "
            "identifier 0x1; give one of them another identifier or another bus");
  EXPECT_EQ(mistakes("[knee_L]\nid = 16\n"),
            "robot.toml:2:6: knee_L.id = 16: identifiers of this driver are 0 to 15");
  EXPECT_TRUE(mistakes("[torso_sensor]\npitch = \"none\"\n").starts_with("robot.toml:2:9: nothing measures"));
  EXPECT_TRUE(mistakes("[torso_sensor]\nencoder_joint = 1\n").starts_with("robot.toml:2:17: torso_sensor."));
}

TEST(Hardware, ThreadsOfAdaptersAndSensorsHaveAPriorityBetweenPlannerAndTorqueLoop) {
  const auto priorities = [](int torque, int planner) {
    return mistakes("[runtime]\ntorque_priority = " + std::to_string(torque) +
                    "\nplanner_priority = " + std::to_string(planner) + "\n");
  };
  EXPECT_EQ(priorities(80, 78), "");
  EXPECT_EQ(priorities(80, 79),
            "robot.toml:3:20: runtime.planner_priority = 79 must be at least 2 below runtime.torque_priority "
            "= 80: the threads of adapters and torso sensors at serial ports have the one between");
  for (const int priority : {80, 85}) EXPECT_NE(priorities(80, priority), "") << priority;
  EXPECT_EQ(priorities(0, 0), "") << "ordinary scheduling has none";
  EXPECT_EQ(priorities(2, 0), "");
  EXPECT_NE(priorities(1, 0), "") << "such a thread would be as ordinary as the planner";
  EXPECT_NE(priorities(0, 60), "");
}

TEST(Hardware, ABusIsACanInterfaceAnAdapterAtAPortOrALoopbackOfSomeName) {
  for (const char* name : {"foo:bar", "loopback:", "fdcanusb:", "fdcanusb:/", "fdcanusb:ttyACM0", "a/b",
                           "an_interface_too_long"}) {
    const auto result = parse(std::string("[hardware]\nbuses = \"can0, ") + name + "\"\n", "robot.toml");
    ASSERT_FALSE(result) << name;
    EXPECT_EQ(to_string(result.error()),
              std::string("robot.toml:2:9: \"") + name +
                  "\" is no bus; a CAN interface such as can0, fdcanusb:/dev/PORT, or loopback:NAME, is one");
  }
  EXPECT_TRUE(parse("[hardware]\nbuses = \"vcan_left,loopback:my_robot\"\n", "robot.toml"));
  EXPECT_TRUE(
      parse("[hardware]\nbuses = \"fdcanusb:/dev/serial/by-id/usb-mjbots_fdcanusb_0123ABCD-if00,can0\"\n",
            "robot.toml"));
}

TEST(Hardware, AnAdapterThatSendsNoEmptyFramesCarriesNoOdriveAndNoCanopenEncoder) {
  const std::string buses = "[hardware]\nbuses = \"can0,fdcanusb:/dev/ttyACM0\"\n";
  const std::string odrive = "[hip_driver]\nprotocol = \"odrive\"\n";
  const auto result = parse(buses + odrive, "robot.toml");
  ASSERT_FALSE(result);
  EXPECT_NE(
      to_string(result.error())
          .find("hip_R.bus = 1: an fdcanusb sends no frame without data, which is how an ODrive is asked; "
                "take a CAN interface for that bus"),
      std::string::npos)
      << to_string(result.error());
  EXPECT_EQ(to_string(result.error()).find("hip_L.bus"), std::string::npos);
  const auto encoder = parse(buses + "[torso_sensor]\ndevice = \"canopen_encoder\"\nbus = 1\n", "robot.toml");
  ASSERT_FALSE(encoder);
  EXPECT_NE(to_string(encoder.error()).find("torso_sensor.bus = 1: an fdcanusb"), std::string::npos)
      << to_string(encoder.error());
}

TEST(Hardware, NodesWhoseFramesCollideAreRefused) {
  EXPECT_EQ(mistakes("[torso_sensor]\nacceleration_x = \"id 0x2 byte 0 bits 16\"\n"),
            "robot.toml:2:18: torso_sensor.acceleration_x and knee_L are on bus 0 and their frames collide: "
            "identifier 0x2 against identifier 0x2; give one of them another identifier or another bus");
  EXPECT_NE(mistakes(with_drivers("odrive", "", "[torso_sensor]\npitch = \"id 0x50 byte 0 bits 32\"\n"))
                .find("identifier 0x50 against identifiers 0x40 to 0x5f"),
            std::string::npos)
      << "ODrive 2";
  EXPECT_EQ(mistakes("[hip_L]\nreply_id = 2\n"),
            "robot.toml: knee_L and hip_L are on bus 0 and their frames collide: identifier 0x2 against "
            "identifier 0x2; give one of them another identifier or another bus")
      << "the answer is another's command";
  EXPECT_EQ(mistakes("[hip_L]\nreply_id = 3\n"), "") << "on another bus";
  EXPECT_EQ(mistakes("[hip_L]\nreply_id = 1\n"), "") << "an AK answers with its own";
  EXPECT_EQ(mistakes("[hip_L]\nreply_id = 0x12\n"), "") << "Damiao: a byte names the driver that replies";
  EXPECT_NE(mistakes("[torso_sensor]\npitch = \"id 0x7ff byte 0 bits 32\"\n")
                .find("torso_sensor.pitch and hip_L are on bus 0 and their frames collide: identifier 0x7ff"),
            std::string::npos)
      << "Damiao registers";
}

TEST(Hardware, IdentifiersEndWhereTheProtocolEnds) {
  // Node 63 of ODrives means all of them; a moteus has no identifier 0.
  for (const auto& [protocol, least, most] : {std::tuple("odrive", 0, 62),
                                              {"moteus", 1, 126},
                                              {"mit_damiao", 0, 15},
                                              {"mit_ak", 0, 255},
                                              {"mit_mini_cheetah", 0, 255},
                                              {"ak_v3", 0, 255}}) {
    const std::string ranges = std::string(protocol) == "ak_v3" ? "position_range_rad = 12.56\n" : "";
    const auto with_id = [&](int id) {
      // Alone on its bus: nothing collides.
      return mistakes(
          with_drivers(protocol, ranges,
                       "[hardware]\nbuses = \"a,b,c\"\n[torso_sensor]\nbus = 1\n[hip_L]\nbus = 2\n"
                       "reply_id = 0x7a0\nid = " +
                           std::to_string(id) + "\n"));
    };
    const std::string range =
        ": identifiers of this driver are " + std::to_string(least) + " to " + std::to_string(most);
    EXPECT_EQ(with_id(least), "") << protocol;
    EXPECT_EQ(with_id(most), "") << protocol;
    EXPECT_NE(with_id(most + 1).find("hip_L.id = " + std::to_string(most + 1) + range), std::string::npos)
        << protocol << with_id(most + 1);
    if (least > 0) {
      EXPECT_NE(with_id(least - 1).find(range), std::string::npos) << protocol;
    }
  }
}

TEST(Hardware, CanFdIsForDriversThatHaveBoth) {
  for (const char* protocol : {"mit_damiao", "odrive"}) {
    EXPECT_EQ(mistakes(with_drivers(protocol, "can_fd = true\n")), "") << protocol;
  }
  for (const auto& [protocol, why] :
       {std::pair{"mit_ak", "_driver.can_fd = true, but this driver has no CAN FD; set it to false"},
        {"mit_mini_cheetah", "_driver.can_fd = true, but this driver has no CAN FD; set it to false"},
        {"ak_v3", "_driver.can_fd = true, but this driver has no CAN FD; set it to false"},
        {"moteus", "_driver.can_fd = true, but a moteus exchanges CAN FD frames by itself"}}) {
    EXPECT_NE(mistakes(with_drivers(protocol, "can_fd = true\n")).find(why), std::string::npos) << protocol;
  }
}

TEST(Hardware, EveryProtocolWorksWithTheShippedIdentifiersAndGains) {
  for (const char* protocol : {"mit_mini_cheetah", "mit_ak", "mit_damiao", "moteus", "odrive"}) {
    EXPECT_EQ(mistakes(with_drivers(protocol, "")), "");
  }
}

TEST(Hardware, ASlowTorsoSensorIsDueEveryFewTicks) {
  HardwareParameters hardware;
  for (const auto& [rate_hz, ticks] : {std::pair{1000.0, 1}, {500.0, 2}, {400.0, 3}, {2000.0, 1}}) {
    hardware.torso_sensor.rate_hz = rate_hz;
    EXPECT_EQ(base_period_ticks(hardware, 1000), ticks) << rate_hz;
  }
}

TEST(Hardware, AMildReactionMustComeBeforeTheHardOne) {
  for (const char* key : {"missed_hold_ticks = 10", "hot_C = 95", "low_voltage_V = 60",
                          "plan_feedback_after_s = 0.3", "torque_loop_overrun_s = 0.02", "stale_plan_s = 11",
                          "heartbeat_timeout_s = 31", "stance_margin_rad = 0.2"}) {
    EXPECT_TRUE(mistakes(std::string("[supervisor]\n") + key + "\n").starts_with("robot.toml:2:")) << key;
  }
}

TEST(Hardware, ADamiaoAndAnAkHaveOneRangeOfTorque) {
  EXPECT_EQ(mistakes("[knee_driver]\nreply_torque_range_Nm = 100\n"),
            "robot.toml:2:25: knee_driver.reply_torque_range_Nm = 100 must be knee_driver.torque_range_Nm = "
            "120: a Damiao has one range for both, its TMAX");
  EXPECT_NE(mistakes("[hip_driver]\ntorque_range_Nm = 100\n"), "");
  EXPECT_EQ(mistakes("[hip_driver]\ntorque_range_Nm = 100\nreply_torque_range_Nm = 100\n"), "");
  EXPECT_NE(mistakes(with_drivers("mit_ak", "torque_range_Nm = 18\n"))
                .find("hip_driver.reply_torque_range_Nm = 120 must be hip_driver.torque_range_Nm = 18: an AK "
                      "of version 1 or 2 has one range for both, that of its model"),
            std::string::npos);
  EXPECT_EQ(mistakes(with_drivers("mit_ak", "torque_range_Nm = 18\nreply_torque_range_Nm = 18\n")), "");
  EXPECT_EQ(mistakes(with_drivers("mit_mini_cheetah", "reply_torque_range_Nm = 100\n")), "");
}

/// Every gain would arrive as another one.
TEST(Hardware, GainsHaveTheRangeOfTheVendorsFirmware) {
  for (const auto& [protocol, drivers] :
       {std::pair{"mit_damiao", "every Damiao"}, {"mit_ak", "every AK of version 1 or 2"}}) {
    const std::string found =
        mistakes(with_drivers(protocol, "kp_range_Nm_rad = 250\nkd_range_Nms_rad = 10\n"));
    for (const std::string section : {"hip_driver", "knee_driver"}) {
      for (const auto& [key, right] :
           {std::pair{".kp_range_Nm_rad = 250", "500"}, {".kd_range_Nms_rad = 10", "5"}}) {
        EXPECT_NE(
            found.find(section + key + ", but that of " + drivers + " is " + right + "; set it to that"),
            std::string::npos)
            << found;
      }
    }
  }
  EXPECT_EQ(mistakes(with_drivers("mit_mini_cheetah", "kp_range_Nm_rad = 250\nkd_range_Nms_rad = 10\n")), "")
      << "its firmware is the user's";
}

TEST(Hardware, ALowVoltageThatAMiniCheetahCannotReportIsRefused) {
  for (const auto& [protocol, volts, refused] : {std::tuple("mit_mini_cheetah", "40", true),
                                                 {"mit_mini_cheetah", "39", false},
                                                 {"mit_ak", "40", false}}) {
    const std::string said =
        mistakes(with_drivers(protocol, "accept_missing_watchdog = true\n",
                              std::string("[supervisor]\nlow_voltage_V = ") + volts + "\n"));
    EXPECT_EQ(
        said.find("supervisor.low_voltage_V = 40 must be below 40 V, the most that a mini-cheetah reports "
                  "(hip_driver.protocol)") != std::string::npos,
        refused)
        << said;
  }
}

TEST(Hardware, TwoTicksFitIntoTheTimeAfterWhichTheTorqueLoopStandsStill) {
  EXPECT_EQ(
      mistakes(
          "[timing]\ntorque_rate_hz = 200\nplan_rate_hz = 200\n[hardware]\nlongest_reply_lag_s = 0.006\n"),
      "");
  EXPECT_TRUE(mistakes("[timing]\ntorque_rate_hz = 150\n").starts_with("robot.toml:2:"));
  EXPECT_TRUE(mistakes("[supervisor]\ntorque_loop_stall_s = 0.0015\n").starts_with("robot.toml:2:"));
}

TEST(Hardware, AReplyMayTakeATickAtLeast) {
  EXPECT_EQ(mistakes("[timing]\ntorque_rate_hz = 500\n"), "");
  EXPECT_EQ(
      mistakes(
          "[timing]\ntorque_rate_hz = 250\nplan_rate_hz = 200\n[hardware]\nlongest_reply_lag_s = 0.004\n"),
      "");
  const std::string slow = mistakes("[timing]\ntorque_rate_hz = 300\n");
  EXPECT_TRUE(slow.starts_with("robot.toml:2:")) << slow;
  EXPECT_NE(slow.find("hardware.longest_reply_lag_s = 0.003 must be at least a tick"), std::string::npos)
      << slow;
}

TEST(Hardware, AWatchdogOfADriverLastsThreeTicks) {
  const std::string slow =
      "[timing]\ntorque_rate_hz = 200\nplan_rate_hz = 200\n[hardware]\nlongest_reply_lag_s = 0.006\n";
  EXPECT_EQ(mistakes(slow + "driver_watchdog_s = 0.015\n"), "");
  const std::string said = mistakes(slow + "driver_watchdog_s = 0.014\n");
  EXPECT_TRUE(said.starts_with("robot.toml:6:")) << said;
  EXPECT_NE(said.find("hardware.driver_watchdog_s = 0.014 must be at least three ticks, 3 / "
                      "timing.torque_rate_hz = 0.015"),
            std::string::npos)
      << said;
}

TEST(Hardware, AnEmergencyStopMayBeSilentForTwoFramesAndTwoTicks) {
  EXPECT_EQ(mistakes("[torso_sensor]\nemergency_stop_timeout_s = 0.006\n"), "");
  const std::string none = "emergency_stop_released = \"none\"\nemergency_stop_timeout_s = 0.002\n";
  EXPECT_EQ(mistakes("[torso_sensor]\n" + none), "") << "is not wired";
  const std::string said = mistakes("[torso_sensor]\nemergency_stop_timeout_s = 0.002\n");
  EXPECT_TRUE(said.starts_with("robot.toml:2:")) << said;
  EXPECT_NE(
      said.find("torso_sensor.emergency_stop_timeout_s = 0.002 must be at least two frames and two ticks, "
                "2 / torso_sensor.rate_hz + 2 / timing.torque_rate_hz = 0.006"),
      std::string::npos)
      << said;
  EXPECT_NE(mistakes("[torso_sensor]\nrate_hz = 5\n"), "") << "frames come too seldom";
  EXPECT_EQ(mistakes("[torso_sensor]\nemergency_stop_timeout_s = 0.5\n"), "");
  EXPECT_NE(mistakes("[torso_sensor]\nemergency_stop_timeout_s = 0.51\n"), "") << "of a cut cable, too";
}

TEST(Hardware, TextsThatAreNotUnderstoodSayWhatWouldBeRight) {
  EXPECT_EQ(mistakes("[hardware]\nrobot = \"atlas\"\n"),
            "robot.toml:2:9: hardware.robot: there is no robot \"atlas\"; known robots are amber3m, "
            "amber3m_2020, rabbit; "
            "or give a file that ends in .urdf");
  EXPECT_EQ(mistakes("[hardware]\nrobot = 3\n"),
            "robot.toml:2:9: hardware.robot must be text, the name of a robot or a file that ends in .urdf, "
            "not a whole number");
  EXPECT_EQ(mistakes("[hardware]\nbuses = \"can0,can0\"\n"),
            "robot.toml:2:9: hardware.buses: names the bus can0 twice");
  EXPECT_EQ(mistakes("[hardware]\nbuses = \"can0,\"\n"),
            "robot.toml:2:9: hardware.buses: \"\" is not the name of a bus; right is an interface such as "
            "can0, fdcanusb:/dev/PORT, or loopback:NAME");
  EXPECT_EQ(mistakes("[hardware]\nbuses = \"a,b,c,d,e\"\n"),
            "robot.toml:2:9: hardware.buses: \"a,b,c,d,e\" names 5 buses; right are 1 to 4, separated by "
            "commas, such as \"can0,can1\"");
  EXPECT_EQ(mistakes("[hardware]\nbuses = \"can\\\"0\"\n"),
            "robot.toml:2:9: hardware.buses must be UTF-8 without quotes, backslashes or control characters");
  EXPECT_NE(mistakes("[torso_sensor]\npitch = \"id 0x900 byte 0 bits 32\"\n").find("no frame holds"),
            std::string::npos);
}

TEST(Hardware, BringUpAndWiringHaveTheNumbersOfTheFile) {
  const Result result = parse(
      "[hardware]\ndriver_watchdog_s = 0.05\nlongest_reply_lag_s = 0.0045\n"
      "[knee_driver]\nprotocol = \"mit_mini_cheetah\"\nminimum_version = 77\nencoder_period_rad = "
      "0.75\naccept_missing_watchdog = true\n"
      "torque_range_Nm = 40\nreply_torque_range_Nm = 45\n"
      "[torso_sensor]\nemergency_stop_timeout_s = 0.25\nencoder_offset_rad = 0.125\n",
      "robot.toml");
  ASSERT_TRUE(result) << to_string(result.error());
  const hal::bring_up::Options knee = bring_up_options(result->hardware, 1, 0, 1, 2);
  EXPECT_EQ(knee.maximum_speed_rad_s, 2 * result->hardware.knee.ratio);
  EXPECT_EQ(knee.longest_reply_lag_ns, 4'500'000);
  EXPECT_EQ(knee.minimum_version, 77u);
  EXPECT_EQ(knee.encoder_period_rad, 0.75);
  EXPECT_TRUE(knee.accept_missing_watchdog);
  EXPECT_EQ(knee.watchdog_s, 0.05);
  const hal::bring_up::Options hip = bring_up_options(result->hardware, 0, 0, 1);
  EXPECT_EQ(hip.minimum_version, 0u);
  EXPECT_EQ(hip.encoder_period_rad, 0);
  EXPECT_FALSE(hip.accept_missing_watchdog);
  const hal::RobotWiring wiring = robot_wiring(result->hardware);
  EXPECT_EQ(wiring.driver_watchdog_s, 0.05);
  EXPECT_EQ(wiring.emergency_stop_timeout_ns, 250'000'000);
  EXPECT_EQ(wiring.pitch_offset_rad, 0.125);
  const auto& driver = std::get<hal::mit::MitDriver>(wiring.joints[1].driver);
  EXPECT_EQ(driver.torque_Nm.maximum, 40);
  EXPECT_EQ(driver.reply_torque_Nm.maximum, 45);
  EXPECT_EQ(driver.reply_torque_Nm.minimum, -45);
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

}  // namespace
}  // namespace stilt::configuration
