#include "host_tools/cli/experiment_walks.h"

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "firmware/configuration/gaits/shipped_gaits.h"
#include "host_tools/cli/run_description.h"
#include "host_tools/simulation/closed_loop/closed_loop.h"
#include "host_tools/simulation/plant/number.h"
#include "host_tools/simulation/plant/simulated_robot.h"

namespace stilt::cli {
namespace {

using experiments::WalkCase;

ControllerChoice choice_of(const WalkSetting& setting, const std::string& controller, double horizon_s) {
  ControllerChoice choice = setting.choice;
  choice.controller = controller;
  choice.horizon_s = horizon_s;
  return choice;
}

ControllerChoice choice_of(const WalkSetting& setting, const WalkCase& walk) {
  ControllerChoice choice = choice_of(setting, walk.controller, walk.horizon_s);
  choice.settings.insert(choice.settings.end(), walk.settings.begin(), walk.settings.end());
  return choice;
}

/// Sensor noise, as options of the plant.
std::vector<std::string> sensor_noise(double scale) {
  struct Noise {
    const char* option;
    double standard_deviation;
  };
  constexpr Noise kNoise[] = {{"encoder_noise_rad", 0.0005},
                              {"encoder_velocity_noise_rad_s", 0.02},
                              {"base_pitch_noise_rad", 0.001},
                              {"base_pitch_rate_noise_rad_s", 0.01}};
  std::vector<std::string> assignments;
  for (const Noise& noise : kNoise) {
    assignments.push_back(std::string(noise.option) + "=" +
                          simulation::number_text(scale * noise.standard_deviation));
  }
  return assignments;
}

/// All changes of the plant, in the order in which they apply.
std::vector<std::string> plant_assignments(const WalkSetting& setting, const WalkCase& walk) {
  std::vector<std::string> all = sensor_noise(walk.sensor_noise_scale);
  all.insert(all.end(), setting.plant_settings.begin(), setting.plant_settings.end());
  all.insert(all.end(), walk.plant.begin(), walk.plant.end());
  return all;
}

simulation::PlantOptions world_of(const WalkSetting& setting, const WalkCase& walk) {
  simulation::PlantOptions world;
  for (const std::string& assignment : plant_assignments(setting, walk)) set_plant_option(world, assignment);
  return world;
}

std::vector<simulation::TimedCommand> commands_of(const WalkCase& walk) {
  std::vector<simulation::TimedCommand> commands = {{0.0, walk.command}};
  commands.insert(commands.end(), walk.later_commands.begin(), walk.later_commands.end());
  return commands;
}

/// The gaits that a controller follows: name and text of each file, in order.
std::string gaits_text(const ControllerChoice& choice) {
  if (gait_library(choice) == nullptr) return "";
  std::map<std::string, std::string> files;
  if (choice.gait_folder.empty()) {
    for (const gait_files::ShippedGait& gait : gait_files::shipped_gaits()) {
      if (gait.robot == choice.robot) files.emplace(gait.path, gait.text);
    }
  } else {
    for (const auto& entry : std::filesystem::directory_iterator(choice.gait_folder)) {
      if (entry.path().extension() != ".toml") continue;
      std::ostringstream text;
      text << std::ifstream(entry.path()).rdbuf();
      files.emplace(entry.path().filename().string(), text.str());
    }
  }
  std::string all;
  for (const auto& [name, text] : files) all.append(name).append("\n").append(text).append("\n");
  return all;
}

/// A word as a shell reads it.
std::string shell_word(const std::string& word) {
  constexpr const char* kPlain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789@%+=:,./_-";
  if (word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char letter : word) quoted += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return quoted + "'";
}

/// The push as an option of `stilt sim`.
std::string push_text(const WalkSetting& setting, const WalkCase& walk) {
  return simulation::number_text(walk.push_N) + "@" + simulation::number_text(walk.push_start_s) + "+" +
         simulation::number_text(walk.push_duration_s) + "@" + setting.push_point;
}

std::vector<simulation::Push> pushes_of(const WalkSetting& setting, const WalkCase& walk) {
  if (walk.push_N == 0.0) return {};
  return {simulation::parse_push(push_text(setting, walk))};
}

log::RunRecord run(const WalkSetting& setting, const WalkCase& walk) {
  const ControllerChoice choice = choice_of(setting, walk);
  const model::RobotModel& robot = robot_model(choice.robot);
  const configuration::Configuration parameters = controller_configuration(choice);
  simulation::PlantOptions world = world_of(setting, walk);
  world.time_step_s =
      simulation::time_step_for_tick(world.time_step_s, 1.0 / parameters.timing.torque_rate_hz);
  simulation::Plant plant(
      simulation::make_plant_model(find_robot(choice.robot).tree, world, parameters.reference.base_height_m),
      world, walk.seed);
  simulation::RunSettings settings;
  settings.duration_s = walk.duration_s;
  settings.leg = {robot.constants.thigh_length_m, robot.constants.shin_length_m};
  settings.commands = commands_of(walk);
  settings.pushes = pushes_of(setting, walk);
  settings.use_true_state = simulation::parse_knows_truth(setting.state);
  settings.measure_from_s = walk.measure_from_s;
  settings.keep_samples = walk.keep_samples;
  if (walk.sample_every_tick) settings.sample_rate_hz = parameters.timing.torque_rate_hz;
  settings.initial_state = standing_on_ground(world, settings.leg, parameters);
  const auto controller = make_controller(controller_setup(choice, robot, parameters));
  log::RunRecord record = simulation::run_closed_loop(plant, *controller, settings);
  describe_run(robot.constants, plant, world, record);
  return record;
}

}  // namespace

WalkSetting setting_for(const WalkSetting& setting, const std::string& controller) {
  WalkSetting own = setting;
  if (controller != "mpc-hzd" && controller != "hzd-pd") own.choice.gait_folder.clear();
  if (controller != "mpc-lumped") own.choice.lump = ControllerChoice{}.lump;
  return own;
}

std::string sim_command(const WalkSetting& setting, const WalkCase& walk) {
  const ControllerChoice choice = choice_of(setting, walk);
  std::string command = "stilt sim";
  const auto add = [&command](const char* option, const std::string& value) {
    if (!value.empty()) command.append(" ").append(option).append(" ").append(shell_word(value));
  };
  add("--robot", choice.robot);
  add("--config", choice.config_file);
  add("--preset", choice.preset);
  add("--controller", choice.controller);
  add("--gaits", choice.gait_folder);
  if (choice.controller == "mpc-lumped") add("--lump", choice.lump);
  add("--horizon", simulation::number_text(walk.horizon_s));
  if (choice.plan_rate_hz) add("--plan-rate", simulation::number_text(*choice.plan_rate_hz));
  if (choice.plan_delay_s) add("--plan-delay", simulation::number_text(*choice.plan_delay_s));
  if (choice.gains) add("--gains", *choice.gains ? "on" : "off");
  for (const std::string& assignment : choice.settings) add("--set", assignment);
  add("--gait", simulation::gait_name(walk.command.kind));
  add("--speed", simulation::number_text(walk.command.speed_m_s));
  for (const simulation::TimedCommand& later : walk.later_commands) {
    add("--then", std::string(simulation::gait_name(later.command.kind)) + ":" +
                      simulation::number_text(later.command.speed_m_s) + "@" +
                      simulation::number_text(later.start_s));
  }
  if (walk.push_N != 0.0) add("--push", push_text(setting, walk));
  add("--state", setting.state);
  for (const std::string& assignment : plant_assignments(setting, walk)) add("--plant", assignment);
  add("--duration", simulation::number_text(walk.duration_s));
  add("--seed", std::to_string(walk.seed));
  return command;
}

std::string dependencies_text(const WalkSetting& setting, const std::string& controller, double horizon_s) {
  const ControllerChoice choice = choice_of(setting, controller, horizon_s);
  std::string text = configuration::to_toml(controller_configuration(choice), "");
  text += find_robot(choice.robot).urdf;
  for (const simulation::PlantOption& option : simulation::plant_option_table()) {
    text += std::string(option.key) + "=" + option.default_text + "\n";
  }
  for (const std::string& assignment : sensor_noise(1.0)) text += assignment + "\n";
  for (const std::string& assignment : setting.plant_settings) text += assignment + "\n";
  text += gaits_text(choice);
  if (controller == "mpc-lumped") text += "lump " + choice.lump + "\n";
  return text + controller + "\n" + setting.push_point + "\n" + setting.state + "\n";
}

std::map<std::string, std::string> parts_of(const WalkSetting& setting,
                                            const std::vector<std::string>& controllers) {
  constexpr double kAnyHorizon_s = 1.0;
  std::map<std::string, std::string> parts;
  for (const std::string& controller : controllers) {
    parts[controller] = dependencies_text(setting_for(setting, controller), controller, kAnyHorizon_s);
  }
  return parts;
}

control::ControllerParameters walk_parameters(const WalkSetting& setting, const std::string& controller,
                                              double horizon_s) {
  return controller_parameters(choice_of(setting, controller, horizon_s));
}

double walk_step_time_s(const WalkSetting& setting, const std::string& controller, double horizon_s) {
  const gait::GaitParameters& gait = walk_parameters(setting, controller, horizon_s).gait;
  return gait.single_support_s + gait.double_support_s;
}

experiments::WalkRunner walk_runner(const WalkSetting& setting) {
  (void)simulation::parse_push("1@1+1@" + setting.push_point);
  (void)simulation::parse_knows_truth(setting.state);
  simulation::PlantOptions checked;
  for (const std::string& assignment : setting.plant_settings) set_plant_option(checked, assignment);
  return [setting](const WalkCase& walk) { return run(setting, walk); };
}

experiments::WalkRunner runner_for_each(const WalkSetting& setting) {
  (void)walk_runner(setting);  // reports errors of the settings before anything runs
  return [setting](const WalkCase& walk) { return run(setting_for(setting, walk.controller), walk); };
}

}  // namespace stilt::cli
