#include "host_tools/cli/robot_command.h"

#include <gtest/gtest.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fstream>
#include <stdexcept>
#include <string>

#include "host_tools/cli/robot_setup.h"
#include "host_tools/cli/usage_error.h"
#include "tests/own_folder.h"

namespace stilt::cli {
namespace {

/// The whole sentence the user gets, or "accepted".
std::string complaint(const RobotOptions& options) {
  try {
    static_cast<void>(simulated_hardware(options));
  } catch (const std::exception& error) {
    return error.what();
  }
  return "accepted";
}

TEST(RobotCommand, TheBusesOfTheConfigurationCanBeReplaced) {
  EXPECT_EQ(simulated_hardware({}).bus_names, (std::vector<std::string>{"can0", "can1"}));
  RobotOptions options;
  options.buses = {"loopback:a", "vcan1"};
  EXPECT_EQ(simulated_hardware(options).bus_names, options.buses);
}

TEST(RobotCommand, FdIsAskedForOnlyWhenADriverNeedsIt) {
  EXPECT_FALSE(simulated_hardware({}).fd);
  RobotOptions options;
  options.settings = {"hip_driver.protocol=moteus"};
  EXPECT_TRUE(simulated_hardware(options).fd);
}

TEST(RobotCommand, ItStandsOnItsGround) {
  RobotOptions options;
  options.plant_settings = {"ground_slope_rad=0.1"};
  const SimulatedHardware sloped = simulated_hardware(options);
  EXPECT_NE(sloped.setup.standing, simulated_hardware({}).setup.standing);
}

TEST(RobotCommand, MistakesAreNamed) {
  RobotOptions options;
  options.buses = {"loopback:a"};
  EXPECT_NE(complaint(options).find("bus"), std::string::npos) << "the right leg is on a second one";
  options = {};
  options.faults = {"fire@1"};
  EXPECT_TRUE(complaint(options).starts_with("--fault fire@1: ")) << complaint(options);
  options.faults = {"bus-off:2@1"};
  EXPECT_TRUE(complaint(options).starts_with("--fault bus-off:2@1: there is no bus 2"));
  options.faults = {"disconnect@1"};
  EXPECT_EQ(complaint(options), "accepted");
  options.lockstep = true;
  EXPECT_TRUE(complaint(options).starts_with("--fault disconnect@1: "));
  options = {};
  options.hang = true;
  options.faults = {"emergency-stop@1"};
  EXPECT_EQ(
      complaint(options),
      "--fault emergency-stop@1: its time counts from the gantry's release, and with --hang there is none; "
      "omit one");
  options = {};
  options.duration_s = 0.0;
  EXPECT_TRUE(complaint(options).starts_with("--duration 0: "));
  options = {};
  options.plant_settings = {"colour=red"};
  EXPECT_TRUE(complaint(options).starts_with("--plant colour"));
  options = {};
  options.config_file = "/nowhere/robot.toml";
  EXPECT_NE(complaint(options).find("/nowhere/robot.toml"), std::string::npos);
}

TEST(RobotCommand, ABusThatIsNotThereIsOneSentence) {
  RobotOptions options;
  options.buses = {"nosuchcan0", "loopback:b"};
  try {
    static_cast<void>(run_robot(options, ""));
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("--bus nosuchcan0: ")) << error.what();
  }
}

/// What the user gets for these hands. In real time, where the robot needs no controller.
std::string complaint_of_hands(const std::string& file, bool hang) {
  const tests::OwnFolder buses;
  RobotOptions options;
  options.buses = {"loopback:" + buses.path().filename().string() + ".left",
                   "loopback:" + buses.path().filename().string() + ".right"};
  options.hands_file = file;
  options.hang = hang;
  try {
    static_cast<void>(run_robot(options, ""));
  } catch (const UsageError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(RobotCommand, MistakesOfHandsAreNamed) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("hands");
  EXPECT_TRUE(complaint_of_hands(file, true).starts_with("--hands " + file + ": cannot be read"));
  EXPECT_TRUE(complaint_of_hands(folder.path(), true).find("cannot be read") != std::string::npos);
  for (const char* line : {"hip_L", "hip_L 0.1 0.2", "hip_L 4", "hip_L nan", "hip_X 0.1", "rock it", "let"}) {
    std::ofstream(file) << "\n  " << line;
    const std::string expected =
        "--hands " + file + ": line 1, \"" + line + "\", is none of JOINT RAD, torso RAD, rock, let go";
    EXPECT_TRUE(complaint_of_hands(file, true).starts_with(expected)) << complaint_of_hands(file, true);
  }
  EXPECT_EQ(complaint_of_hands(file, false), "--hands: the robot must hang for good; add --hang");
}

}  // namespace
}  // namespace stilt::cli
