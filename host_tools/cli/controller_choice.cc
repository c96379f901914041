#include "host_tools/cli/controller_choice.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <system_error>

#include "firmware/configuration/gaits/gait_file.h"
#include "firmware/configuration/gaits/gait_overrides.h"
#include "firmware/configuration/gaits/shipped_gaits.h"
#include "firmware/configuration/reach.h"
#include "firmware/program/instruction_sets.h"
#include "host_tools/cli/usage_error.h"
#include "host_tools/experiments/planning_model/lumped.h"
#include "host_tools/simulation/plant/number.h"

namespace stilt::cli {
namespace {

using configuration::Override;

/// "section.key=value" with all digits of the value.
Override setting(const char* key, double value, const char* option) {
  char text[40];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value);
  return {std::string(key) + "=" + std::string(text, end), option};
}

/// What the options set; of any robot.
std::vector<Override> option_overrides(const ControllerChoice& choice) {
  std::vector<Override> overrides;
  for (const std::string& assignment : choice.settings) overrides.push_back({assignment});
  if (choice.horizon_s)
    overrides.push_back(setting("discretisation.horizon_s", *choice.horizon_s, "--horizon"));
  if (choice.iterations) {
    overrides.push_back({"sqp.iterations=" + std::to_string(*choice.iterations), "--iterations"});
  }
  if (choice.plan_rate_hz) {
    overrides.push_back(setting("timing.plan_rate_hz", *choice.plan_rate_hz, "--plan-rate"));
  }
  if (choice.plan_delay_s) {
    overrides.push_back(setting("timing.plan_delay_s", *choice.plan_delay_s, "--plan-delay"));
  }
  if (choice.gains) {
    overrides.push_back(
        {std::string("torque_law.use_feedback_gains=") + (*choice.gains ? "true" : "false"), "--gains"});
  }
  if (choice.no_early_stop) overrides.push_back({"sqp.early_stop=false", "--no-early-stop"});
  if (choice.controller == "hzd-pd") {
    overrides.push_back({"supervisor.select_gait=true", "--controller hzd-pd"});
  }
  if (choice.controller == "mpc-none") overrides.push_back({"cost.terminal=0", "--controller mpc-none"});
  return overrides;
}

/// What the gaits of the controller need, then the user's options, which may change it.
/// @param library  null where none is followed
std::vector<Override> overrides_of(const ControllerChoice& choice, const gait::GaitLibrary* library) {
  std::vector<Override> overrides;
  if (library != nullptr) overrides = gait_files::gait_overrides(*library, "--controller mpc-hzd");
  const std::vector<Override> options = option_overrides(choice);
  overrides.insert(overrides.end(), options.begin(), options.end());
  return overrides;
}

bool follows_gaits(const std::string& controller) {
  return controller == "mpc-hzd" || controller == "hzd-pd";
}

/// The gaits shipped for a robot; null when there are none.
std::shared_ptr<const gait::GaitLibrary> shipped_library(const std::string& robot) {
  auto library = std::make_shared<gait::GaitLibrary>();
  if (!gait_files::load_shipped_library(robot, *library)) return nullptr;
  return library;
}

std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string one_line(const std::vector<configuration::Diagnostic>& diagnostics) {
  std::string text;
  for (const configuration::Diagnostic& diagnostic : diagnostics) {
    text += (text.empty() ? "" : "; ") + configuration::to_string(diagnostic);
  }
  return text;
}

}  // namespace

const std::vector<std::string>& controller_names() {
  static const std::vector<std::string> names = {"mpc-none", "mpc-heuristic", "mpc-hzd", "mpc-lumped",
                                                 "hzd-pd"};
  return names;
}

const std::vector<std::string>& lump_names() {
  static const std::vector<std::string> names = {"legs", "drives", "law"};
  return names;
}

void check_controller(const std::string& name) {
  if (std::ranges::find(controller_names(), name) != controller_names().end()) return;
  throw UsageError("--controller " + name + ": no such controller; known are " + listed(controller_names()));
}

void add_preset_option(CLI::App& command, std::string& preset) {
  command.add_option("--preset", preset,
                     "shipped changes to the configuration, before --set: " + configuration::preset_names());
}

void add_gains_option(CLI::App& command, ControllerChoice& choice) {
  command
      .add_option_function<std::string>(
          "--gains", [&choice](const std::string& text) { choice.gains = text == "on"; },
          "the plan's feedback gains in the torque law: on, off; default: torque_law.use_feedback_gains")
      ->check(CLI::IsMember({"on", "off"}));
}

void add_controller_options(CLI::App& command, ControllerChoice& choice) {
  const CLI::Option* robot =
      command.add_option("--robot", choice.robot, robot_help() + "; default: that of --config")
          ->capture_default_str();
  command.parse_complete_callback([&choice, robot] {
    if (robot->count() > 0 || choice.config_file.empty()) return;
    // A mistake in it is reported when the command reads it.
    const auto read = configuration::load(choice.config_file, "", option_overrides(choice), choice.preset);
    if (read) choice.robot = read->hardware.robot;
  });
  command
      .add_option("--controller", choice.controller,
                  "mpc-heuristic, mpc-none: without terminal cost, mpc-lumped: plans with the legs' mass and "
                  "inertia in the torso, mpc-hzd: around the gaits of a library, "
                  "hzd-pd: those gaits tracked by the joints, after two seconds of mpc-hzd")
      ->capture_default_str();
  command
      .add_option("--lump", choice.lump,
                  "what mpc-lumped neglects: legs (mass and inertia of the links), drives (and their "
                  "armature), law (and both in the torque law)")
      ->capture_default_str();
  command.add_option("--gaits", choice.gait_folder, "folder of gait files instead of the shipped ones");
  command.add_option("--config", choice.config_file,
                     "controller configuration (TOML) instead of the shipped one");
  add_preset_option(command, choice.preset);
  command
      .add_option("--set", choice.settings,
                  "changes one key of the configuration: section.key=value; repeatable")
      ->allow_extra_args(false);
  const configuration::Configuration shipped;
  command
      .add_option("--horizon", choice.horizon_s,
                  "horizon of the planner, s; default: discretisation.horizon_s")
      ->default_str(simulation::number_text(shipped.discretisation.horizon_s));
  command
      .add_option("--iterations", choice.iterations,
                  "largest number of SQP iterations per plan; default: sqp.iterations")
      ->default_str(std::to_string(shipped.sqp.iterations));
}

std::string robot_help() { return "robot: " + robots::shipped_names() + ", or a URDF file"; }

const robots::Robot& find_robot(const std::string& name) {
  const auto robot = robots::find(name);
  if (!robot) throw UsageError("--robot: " + robot.error());
  return **robot;
}

const model::RobotModel& robot_model(const std::string& name) { return find_robot(name).model; }

std::vector<std::string> files_read(const CommandInputs& inputs) {
  std::vector<std::string> files = configuration::files_of_robot(inputs.robot);
  files.insert(files.end(), {inputs.config_file, inputs.gait_file});
  // A mistake in folder or file is reported when the command reads it.
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(inputs.gait_folder, error)) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path().string());
  }
  if (!std::filesystem::is_regular_file(inputs.gait_file, error)) return files;  // a FIFO is read once
  if (const auto gait = gait_files::load_gait(inputs.gait_file)) {
    const std::vector<std::string> of_robot = configuration::files_of_robot(gait->robot);
    files.insert(files.end(), of_robot.begin(), of_robot.end());
  }
  return files;
}

std::vector<std::string> files_read(const ControllerChoice& choice) {
  return files_read(CommandInputs{choice.robot, choice.config_file, choice.gait_folder, ""});
}

configuration::Configuration load_configuration(const std::string& robot, const std::string& file,
                                                const std::string& preset,
                                                const std::vector<Override>& overrides) {
  const configuration::Result result = configuration::load(file, robot, overrides, preset);
  if (!result) throw UsageError(one_line(result.error()));
  return *result;
}

configuration::Configuration controller_configuration(const ControllerChoice& choice) {
  check_controller(choice.controller);
  const auto library = gait_library(choice);
  configuration::Configuration configuration = load_configuration(
      choice.robot, choice.config_file, choice.preset, overrides_of(choice, library.get()));
  if (configuration.hardware.robot != choice.robot) {
    throw UsageError("hardware.robot: " + configuration.hardware.robot + " is another robot than " +
                     choice.robot + "; take --robot " + configuration.hardware.robot);
  }
  const auto poses = configuration::unreachable_poses(configuration, robot_model(choice.robot).constants);
  if (!poses.empty()) throw UsageError(poses.front());
  if (library != nullptr) {
    const auto wrong = gait_files::other_step_time(*library, configuration);
    if (wrong) throw UsageError("--controller " + choice.controller + ": " + *wrong);
  }
  configuration::keep_torque_limit(configuration);
  return configuration;
}

control::ControllerParameters controller_parameters(const ControllerChoice& choice) {
  return controller_configuration(choice);
}

std::shared_ptr<const gait::GaitLibrary> gait_library(const ControllerChoice& choice) {
  if (!follows_gaits(choice.controller)) {
    if (choice.gait_folder.empty()) return nullptr;
    throw UsageError("--gaits " + choice.gait_folder + ": only --controller mpc-hzd and hzd-pd follow gaits");
  }
  auto library = std::make_shared<gait::GaitLibrary>();
  const bool shipped = choice.gait_folder.empty();
  const auto loaded = shipped ? gait_files::load_shipped_library(choice.robot, *library)
                              : gait_files::load_library(choice.gait_folder, choice.robot, *library);
  if (!loaded) {
    throw UsageError("--controller " + choice.controller + ": " + loaded.error() +
                     (shipped ? "; stilt gait library makes a folder of them" : ""));
  }
  return library;
}

const model::RobotModel* planning_model(const ControllerChoice& choice) {
  if (std::ranges::find(lump_names(), choice.lump) == lump_names().end()) {
    throw UsageError("--lump " + choice.lump + ": known are " + listed(lump_names()));
  }
  if (choice.controller != "mpc-lumped") {
    if (choice.lump == ControllerChoice{}.lump) return nullptr;
    throw UsageError("--lump " + choice.lump + ": only --controller mpc-lumped neglects mass and inertia");
  }
  const auto lump = choice.lump == "legs" ? planning_model::Lump::legs : planning_model::Lump::drives;
  return &planning_model::lumped(robot_model(choice.robot), lump);
}

simulation::ControllerSetup controller_setup(const ControllerChoice& choice, const model::RobotModel& robot,
                                             const configuration::Configuration& configuration) {
  simulation::ControllerSetup setup;
  setup.planning_model = planning_model(choice);
  const bool lumped_law = setup.planning_model != nullptr && choice.lump == "law";
  setup.robot = lumped_law ? setup.planning_model : &robot;
  setup.parameters = configuration;
  setup.supervision = configuration.supervisor;
  setup.reference_gaits = gait_library(choice);
  if (configuration.supervisor.track_gait) {
    setup.fallback_gaits =
        setup.reference_gaits != nullptr ? setup.reference_gaits : shipped_library(choice.robot);
  }
  return setup;
}

std::unique_ptr<simulation::SimulatedController> make_controller(const simulation::ControllerSetup& setup) {
  auto controller = std::make_unique<simulation::SimulatedController>();
  switch (controller->configure(setup)) {
    case control::ConfigureStatus::ok:
      return controller;
    case control::ConfigureStatus::horizon_over_capacity:
      throw UsageError("discretisation.horizon_s " +
                       simulation::number_text(setup.parameters.discretisation.horizon_s) +
                       ": the horizon needs more intervals or contact switches than the planner holds; "
                       "take a shorter horizon or a longer time step");
    case control::ConfigureStatus::no_such_instructions:
      throw UsageError(program::no_such_instructions(setup.parameters));
    case control::ConfigureStatus::terminal_cost_failed:
      break;
  }
  throw UsageError(
      "cost: these weights admit no terminal cost; give every position and velocity some weight, or set "
      "cost.terminal to 0");
}

}  // namespace stilt::cli
