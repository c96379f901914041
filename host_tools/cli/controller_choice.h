#pragma once

#include <CLI/App.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/configuration/configuration.h"
#include "firmware/robots/robots.h"
#include "host_tools/simulation/closed_loop/simulated_controller.h"
#include "mpc_core/control/parameters.h"
#include "mpc_core/model/robot.h"

/// Configures a controller from the user's options. All functions throw UsageError, one sentence.
namespace stilt::cli {

/// The options that choose robot, controller and parameters.
struct ControllerChoice {
  std::string robot = "amber3m";
  std::string controller = "mpc-heuristic";
  std::string config_file;            ///< empty: the file shipped for the robot
  std::string preset;                 ///< of --preset; empty: none
  std::vector<std::string> settings;  ///< of --set
  std::optional<double> horizon_s;
  std::optional<int> iterations;
  std::optional<double> plan_rate_hz;
  std::optional<double> plan_delay_s;
  std::optional<bool> gains;  ///< of --gains: the plan's feedback gains in the torque law
  bool no_early_stop = false;
  std::string lump = "drives";  ///< of --lump, for mpc-lumped: legs, drives or law
  std::string gait_folder;      ///< of --gaits; empty: the gaits shipped for the robot
};

/// Valid values of --controller and --lump.
[[nodiscard]] const std::vector<std::string>& controller_names();
[[nodiscard]] const std::vector<std::string>& lump_names();

/// Throws UsageError unless `name` is the name of a controller.
void check_controller(const std::string& name);

/// Adds --preset to a command.
void add_preset_option(CLI::App& command, std::string& preset);

/// Adds the options that `stilt sim` and `stilt bench` share to a command.
void add_controller_options(CLI::App& command, ControllerChoice& choice);

/// Adds --gains on|off to a command.
void add_gains_option(CLI::App& command, ControllerChoice& choice);

/// Help text of --robot: its valid values.
[[nodiscard]] std::string robot_help();

/// The robot of that name or URDF file, and its model.
[[nodiscard]] const robots::Robot& find_robot(const std::string& name);
[[nodiscard]] const model::RobotModel& robot_model(const std::string& name);

/// What a command reads, as its command line names it; empty: none.
struct CommandInputs {
  std::string robot;  ///< name or URDF file
  std::string config_file;
  std::string gait_folder;
  std::string gait_file;
};

/// The files of all that. The TOML beside a URDF, the robot of a gait file and the gaits of a folder are
/// among them. The command does not write to them.
[[nodiscard]] std::vector<std::string> files_read(const CommandInputs& inputs);

/// The same of the options that choose robot and controller.
[[nodiscard]] std::vector<std::string> files_read(const ControllerChoice& choice);

/// The configuration of a file, or that shipped for the robot when the name is empty. The preset changes it,
/// then the overrides. All values are checked.
[[nodiscard]] configuration::Configuration load_configuration(
    const std::string& robot, const std::string& file, const std::string& preset,
    const std::vector<configuration::Override>& overrides);

/// The configuration from the file, --preset, --set and the other options, checked.
[[nodiscard]] configuration::Configuration controller_configuration(const ControllerChoice& choice);

/// The part of it that planner and torque law use.
[[nodiscard]] control::ControllerParameters controller_parameters(const ControllerChoice& choice);

/// The chosen controller of a robot and the gaits that it follows, as input of make_controller().
[[nodiscard]] simulation::ControllerSetup controller_setup(const ControllerChoice& choice,
                                                           const model::RobotModel& robot,
                                                           const configuration::Configuration& configuration);

/// A configured controller.
[[nodiscard]] std::unique_ptr<simulation::SimulatedController> make_controller(
    const simulation::ControllerSetup& setup);

/// The planner's model when it is not that of the robot; otherwise null.
[[nodiscard]] const model::RobotModel* planning_model(const ControllerChoice& choice);

/// The gaits that the chosen controller follows: those of --gaits or the shipped ones. Null for a controller
/// that follows none.
[[nodiscard]] std::shared_ptr<const gait::GaitLibrary> gait_library(const ControllerChoice& choice);

}  // namespace stilt::cli
