#pragma once

#include <cstddef>
#include <expected>
#include <optional>
#include <string>
#include <vector>

#include "firmware/commissioning/calibration.h"
#include "firmware/configuration/configuration.h"
#include "mpc_core/gait/command.h"

namespace stilt::program {

/// What the command line asks of stiltd.
enum class Task {
  control,       ///< run the controller
  self_test,     ///< command the drivers at zero torque and report
  scan,          ///< find the drivers of the buses
  watch,         ///< show joints and sensors, limp
  jog,           ///< move one joint, ask which link moved
  zero,          ///< make the position of a joint the zero of its driver
  calibrate,     ///< signs and offsets, from joints that a person moves
  identify,      ///< friction, inertia and torque constant of each drive
  check_config,  ///< read the configuration, print what it means, and end
  interrupts,    ///< raise the interrupt threads of the buses above the planner
  print_config,  ///< write the configuration with every key
  nothing,       ///< --help or --version: printed already
};

/// Commands that close loops of torque without the controller.
[[nodiscard]] constexpr bool gives_torque(Task task) noexcept {
  return task == Task::jog || task == Task::identify;
}

/// What the command line asks for.
struct Options {
  Task task = Task::control;
  configuration::Configuration configuration;
  std::string source;                      ///< the file, or the shipped one, that it was read from; preset
  std::optional<gait::GaitCommand> start;  ///< go there without an operator
  double duration_s = 0.0;                 ///< then sit down and end; 0: until stopped
  bool lockstep = false;
  std::string json_file;         ///< "-": standard output; empty: none
  std::string black_box_file;    ///< empty: none
  bool forbid_syscalls = false;  ///< for proofs: see realtime::forbid_other_system_calls()
  double planner_until_s = 0.0;  ///< for tests: no plans from states later than this; 0: always
  double self_test_s = 10.0;
  bool accept_missing_stop = false;  ///< selftest passes a robot whose emergency stop is not reported
  bool hangs = false;                ///< selftest requires legs that hang plumb
  std::size_t joint = 0;             ///< of jog and zero
  double jog_angle_rad = 0.0;
  double torque_limit_share = 1.0;           ///< of --torque-limit, in the configuration already
  std::vector<std::string> interrupt_buses;  ///< of interrupts; none: those of the configuration
  std::string answers_file;                  ///< answers to what a command asks; empty: standard input
  std::string config_file;                   ///< of --config; empty: none
  std::string out_file;                      ///< configuration to write what was found to; empty: none
  std::vector<std::string> changed_keys;     ///< "section.key" that --preset, --set and --bus have set
  bool refused = false;                      ///< by read_options(): the robot's files may be unknown
  commissioning::Reference reference = commissioning::Reference::stops;
  double identify_torque_share = 0.3;

  /// Whether the planner still works at this time of the controller.
  [[nodiscard]] bool plans_at(double time_s) const noexcept {
    return planner_until_s <= 0.0 || time_s < planner_until_s;
  }
};

/// Reads the command line and the configuration. The error is for the user: a sentence, or a line for each
/// mistake of the configuration. `options` then has task, json_file and config_file, for the JSON of the
/// refusal.
/// `version`: what --version prints.
[[nodiscard]] std::expected<void, std::string> read_options(int argc, char** argv, const std::string& version,
                                                            Options& options);

/// Refuses results that would replace each other, the configuration, the files of the robot or the answers.
/// One sentence; empty where each has its place. `--out` is read before it is changed. A command line that
/// was refused may name a robot that is not known yet: its JSON replaces JSON alone.
[[nodiscard]] std::string file_conflict(const Options& options);

/// stand, step or walk@SPEED: the error says what would be right.
[[nodiscard]] std::expected<gait::GaitCommand, std::string> parse_start(const std::string& text);

}  // namespace stilt::program
