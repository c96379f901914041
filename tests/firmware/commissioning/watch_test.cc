#include "firmware/commissioning/watch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "firmware/commissioning/unknown_turns.h"
#include "tests/firmware/commissioning/hanging_robot.h"

namespace stilt::commissioning {
namespace {

using testing::HangingRobot;

const std::vector<std::string> kOdrive = {"hip_driver.protocol=odrive", "knee_driver.protocol=odrive",
                                          "hip_driver.accept_missing_watchdog=true",
                                          "knee_driver.accept_missing_watchdog=true"};

std::vector<WatchSample> watched(HangingRobot& robot, double duration_s) {
  Session session = robot.session();
  std::vector<WatchSample> samples;
  const auto done =
      watch(session, duration_s, [&samples](const WatchSample& sample) { samples.push_back(sample); });
  EXPECT_TRUE(done) << done.error();
  return samples;
}

TEST(Watch, ShowsTheAnglesOfTheRobotTenTimesPerSecond) {
  HangingRobot robot;
  const std::vector<WatchSample> samples = watched(robot, 2.0);
  ASSERT_EQ(samples.size(), 20u);
  const model::StateVector state = robot.robot.plant().state();
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    const hal::JointReading& reading = samples.back().readings.joints[joint];
    EXPECT_NEAR(reading.position_rad, state[model::kFirstJoint + static_cast<int>(joint)], 0.2);
    EXPECT_EQ(reading.state, hal::DriverState::enabled);
  }
  EXPECT_EQ(samples.back().readings.emergency_stop, hal::EmergencyStopState::released);
}

/// The bytes of the vendors' manuals, not our codecs: kp, kd and torque of an MIT frame.
void expect_limp_mit(const hal::CanFrame& frame) {
  const bool special = frame.data[6] == 0xff && frame.data[5] == 0xff;
  if (frame.id == 0x7ff || special) return;  // a register of a Damiao; motor on, motor off
  const unsigned kp = (frame.data[3] & 0xfu) << 8 | frame.data[4];
  const unsigned kd = static_cast<unsigned>(frame.data[5]) << 4 | frame.data[6] >> 4;
  const unsigned torque = (frame.data[6] & 0xfu) << 8 | frame.data[7];
  EXPECT_EQ(kp, 0u);
  EXPECT_EQ(kd, 0u);
  EXPECT_TRUE(torque == 0x7ff || torque == 0x800) << torque;
}

TEST(Watch, NoFrameAsksForATorqueOrAGain) {
  HangingRobot damiao;
  static_cast<void>(watched(damiao, 1.0));
  for (const testing::DirectBus& bus : damiao.buses) {
    EXPECT_GT(bus.sent.size(), 1000u);
    for (const hal::CanFrame& frame : bus.sent) expect_limp_mit(frame);
  }
  HangingRobot odrive({.both = kOdrive, .robot = {}, .miswired = {}});
  static_cast<void>(watched(odrive, 1.0));
  for (const testing::DirectBus& bus : odrive.buses) {
    constexpr unsigned kSetInputTorque = 0x0e;
    long torques = 0;
    for (const hal::CanFrame& frame : bus.sent) {
      if (frame.remote || (frame.id & 0x1f) != kSetInputTorque) continue;
      ++torques;
      EXPECT_EQ(frame.data[0] | frame.data[1] | frame.data[2] | (frame.data[3] & 0x7f), 0);
    }
    EXPECT_GT(torques, 1000);
  }
}

TEST(Watch, MotorsOfEveryProtocolGiveNoTorqueWhileTheLegsSwing) {
  const std::vector<std::vector<std::string>> protocols = {
      {},
      kOdrive,
      {"hip_driver.protocol=mit_ak", "knee_driver.protocol=mit_ak", "hip_driver.accept_missing_watchdog=true",
       "knee_driver.accept_missing_watchdog=true"},
      testing::kAkV3,
      {"hip_driver.protocol=moteus", "knee_driver.protocol=moteus"}};
  for (const std::vector<std::string>& settings : protocols) {
    HangingRobot robot({.both = settings, .robot = {}, .miswired = {}});
    EXPECT_FALSE(watched(robot, 1.0).empty());
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      constexpr double kHalfAStepOfAFrame_Nm = 0.03;
      EXPECT_LE(robot.peak_torque_Nm(joint), kHalfAStepOfAFrame_Nm);
    }
  }
}

TEST(Watch, AnAkOfVersionThreeGetsLimpCommandsOfEightBytesAlone) {
  HangingRobot robot({.both = testing::kAkV3, .robot = {}, .miswired = {}});
  static_cast<void>(watched(robot, 1.0));
  for (const testing::DirectBus& bus : robot.buses) {
    EXPECT_GT(bus.sent.size(), 1000u);
    for (const hal::CanFrame& frame : bus.sent) {
      EXPECT_TRUE(frame.extended);
      EXPECT_EQ(frame.id >> 8, 8u);
      ASSERT_EQ(frame.length, 8);
      EXPECT_EQ(frame.data[0] | frame.data[1] | frame.data[2], 0) << "kp and kd";
      const unsigned torque = (frame.data[6] & 0xfu) << 8 | frame.data[7];
      EXPECT_TRUE(torque == 0x7ff || torque == 0x800) << torque;
    }
  }
}

TEST(Watch, DriversAreOffAtTheEnd) {
  HangingRobot robot;
  static_cast<void>(watched(robot, 0.2));
  static_cast<void>(robot.sleep_until(robot.now_ns() + 2'000'000));
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    EXPECT_FALSE(robot.robot.drivers().driver(joint).enabled());
  }
}

TEST(Watch, NeedsNoOffsets) {
  HangingRobot robot({.both = {}, .robot = {"hip_L.offset_rad=2.5"}, .miswired = {}});
  EXPECT_EQ(watched(robot, 0.2).size(), 2u);
}

/// Of moteus without an encoder at their outputs, as first-day.md has them before offsets are known.
TEST(Watch, ARotorsEncoderIsEnoughAndItsTurnIsCalledUnknown) {
  for (const char* period_rad : {"0", "1.0"}) {
    HangingRobot robot({.both = {"hip_driver.protocol=moteus", "knee_driver.protocol=moteus",
                                 std::string("hip_driver.encoder_period_rad=") + period_rad},
                        .robot = {},
                        .miswired = {}});
    EXPECT_EQ(watched(robot, 0.2).size(), 2u);
    EXPECT_EQ(unknown_turns(*robot.hardware), "");
    robot.reference_to_rotors();
    EXPECT_EQ(watched(robot, 0.2).size(), 2u) << period_rad;
    EXPECT_EQ(unknown_turns(*robot.hardware),
              "hip_L, knee_L, hip_R, knee_R: the angle may be wrong by whole turns of the rotor, whose "
              "encoder the driver has alone");
  }
}

TEST(Watch, SaysWhichDriverCannotBeBroughtUp) {
  HangingRobot robot({.both = {}, .robot = {"hip_R.id=9"}, .miswired = {}});
  Session session = robot.session();
  const auto done = watch(session, 1.0, [](const WatchSample&) {});
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error(), "the driver of hip_R cannot be brought up: no answer");
}

/// What each of these drivers is refused for, and the keys that end that.
TEST(Watch, NamesTheKeysOfADriverWithoutAWatchdog) {
  const auto error = [](const std::vector<std::string>& settings, const std::string& section) {
    std::vector<std::string> both = settings;
    both.push_back(section + ".accept_missing_watchdog=false");
    HangingRobot robot({.both = both, .robot = {}, .miswired = {}});
    Session session = robot.session();
    const auto done = watch(session, 1.0, [](const WatchSample&) {});
    return done ? "" : done.error();
  };
  EXPECT_EQ(error(kOdrive, "hip_driver"),
            "the driver of hip_L cannot be brought up: has no watchdog; in hip_driver, "
            "odrive_watchdog_timeout_endpoint and odrive_enable_watchdog_endpoint must be the ids of "
            "axis0.config.watchdog_timeout and axis0.config.enable_watchdog in flat_endpoints.json of its "
            "firmware, "
            "or accept_missing_watchdog must be true");
  EXPECT_EQ(
      error(testing::kAkV3, "knee_driver"),
      "the driver of knee_L cannot be brought up: has no watchdog; in knee_driver, accept_missing_watchdog "
      "must be true, and the emergency stop must cut its supply");
}

TEST(Watch, NamesBothVersionsOfAnOdriveThatIsNotThatOfItsEndpoints) {
  HangingRobot robot({.both = testing::kOdriveWithWatchdog,
                      .robot = {"hip_driver.odrive_hardware_version=5.2.0"},
                      .miswired = {}});
  Session session = robot.session();
  const auto done = watch(session, 1.0, [](const WatchSample&) {});
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error(),
            "the driver of hip_L cannot be brought up: version differs from the configuration: 5.2.0 instead "
            "of 4.4.58; in hip_driver, odrive_hardware_version must be that of the driver, and all endpoints "
            "those of its flat_endpoints.json");
}

/// Their emulated drivers have no such parameters.
TEST(Watch, NamesTheEndpointsOfAnOdriveThatAreNotThoseOfItsWatchdog) {
  HangingRobot robot({.both = testing::kOdriveWithWatchdog,
                      .robot = {"hip_driver.odrive_enable_watchdog_endpoint=19"},
                      .miswired = {}});
  Session session = robot.session();
  const auto done = watch(session, 1.0, [](const WatchSample&) {});
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error(),
            "the driver of hip_L cannot be brought up: watchdog is not the one that was set; in hip_driver, "
            "odrive_watchdog_timeout_endpoint and odrive_enable_watchdog_endpoint are other parameters: they "
            "must be the ids of axis0.config.watchdog_timeout and axis0.config.enable_watchdog in "
            "flat_endpoints.json of its firmware");
}

TEST(Watch, ALineOfJsonIsASampleAndATableHasItsLines) {
  HangingRobot robot;
  const WatchSample sample = watched(robot, 0.2).back();
  const auto json = nlohmann::json::parse(to_json_line(sample));
  EXPECT_EQ(json["joints"]["knee_R"]["position_rad"], sample.readings.joints[3].position_rad);
  EXPECT_TRUE(json["joints"]["knee_R"]["supply_V"].is_null());
  EXPECT_EQ(json["emergency_stop"], "released");
  const std::string table = to_table(sample);
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), kWatchLines);
}

TEST(Watch, IsWellWhileAllReportAndTheStopIsReleased) {
  HangingRobot robot;
  const WatchSample well = watched(robot, 0.2).back();
  EXPECT_TRUE(good(well)) << to_table(well);
  WatchSample without_stop = well;
  without_stop.readings.emergency_stop = hal::EmergencyStopState::absent;
  EXPECT_TRUE(good(without_stop));
  for (const auto stop : {hal::EmergencyStopState::pressed, hal::EmergencyStopState::unknown}) {
    WatchSample sample = well;
    sample.readings.emergency_stop = stop;
    EXPECT_FALSE(good(sample)) << to_table(sample);
  }
  WatchSample torso = well;
  torso.readings.base.missed_replies = kSilentReads + 1;
  EXPECT_FALSE(good(torso));
  WatchSample faulty = well;
  faulty.readings.joints[1].fault = hal::DriverFault::over_voltage;
  EXPECT_FALSE(good(faulty));
  WatchSample off = well;
  off.readings.joints[2].state = hal::DriverState::idle;
  EXPECT_FALSE(good(off));
}

TEST(Watch, AJointThatIsSilentIsNotWellAndNamedSo) {
  HangingRobot robot;
  robot.lost_id = 0x14;  // replies of knee_R
  robot.lost_from_ns = robot.now_ns() + 2'000'000'000;
  const WatchSample sample = watched(robot, 3.0).back();
  EXPECT_FALSE(good(sample)) << to_table(sample);
  const auto json = nlohmann::json::parse(to_json_line(sample));
  EXPECT_EQ(json["joints"]["knee_R"]["mode"], "silent");
  EXPECT_EQ(json["joints"]["hip_R"]["mode"], "enabled");
}

/// A longer line wraps on a terminal of 80 columns, and the next table is drawn below its remains.
TEST(Watch, NoLineOfTheTableIsLongerThanATerminalIsWide) {
  WatchSample sample;
  const auto expect_fits = [&sample] {
    const std::string table = to_table(sample);
    EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), kWatchLines) << table;
    std::istringstream lines(table);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
    return table;
  };
  for (hal::JointReading& joint : sample.readings.joints) {
    joint = {.position_rad = -1.5, .velocity_rad_s = -2.5, .torque_Nm = -80.25};
    joint.driver_temperature_C = joint.motor_temperature_C = 100;
    joint.supply_V = 48.5;
    joint.state = hal::DriverState::enabled;
  }
  EXPECT_NE(expect_fits().find("driver faults   none\n"), std::string::npos);
  for (hal::JointReading& joint : sample.readings.joints) joint.missed_replies = 100;
  sample.readings.base.missed_replies = 100;
  const std::string silent = expect_fits();
  EXPECT_NE(silent.find("  SILENT\nknee_L "), std::string::npos) << silent;
  EXPECT_NE(silent.find("-  SILENT\ndriver faults"), std::string::npos) << silent;
  for (hal::JointReading& joint : sample.readings.joints) {
    joint.fault = hal::DriverFault::driver_over_temperature;
    joint.fault_code = 4294967295;
    joint.state = hal::DriverState::fault;
    joint.position_rad = -25736.123;
    joint.velocity_rad_s = joint.torque_Nm = -1e300;
  }
  const std::string faults = expect_fits();
  EXPECT_NE(faults.find("hip_L    -25736.1 -1474571-1.0e+300-1.0e+300      100      100     48.5  SILENT\n"),
            std::string::npos)
      << faults;
  EXPECT_NE(faults.find("driver faults   hip_L driver over temperature, vendor code 4294967295, 3 more\n"),
            std::string::npos)
      << faults;
  for (std::size_t joint = 0; joint < 3; ++joint)
    sample.readings.joints[joint].fault = hal::DriverFault::none;
  EXPECT_NE(expect_fits().find("knee_R driver over temperature, vendor code 4294967295\n"),
            std::string::npos);
}

}  // namespace
}  // namespace stilt::commissioning
