#include "host_tools/cli/robot_setup.h"

#include <algorithm>
#include <cstdio>
#include <variant>

#include "firmware/configuration/configuration.h"
#include "hal/robot/wiring_load.h"
#include "host_tools/cli/check_duration.h"
#include "host_tools/cli/controller_choice.h"
#include "host_tools/cli/run_description.h"
#include "host_tools/cli/usage_error.h"
#include "host_tools/simulation/closed_loop/closed_loop.h"
#include "host_tools/simulation/plant/number.h"
#include "host_tools/simulation/plant/simulated_robot.h"

namespace stilt::cli {
namespace {

configuration::Configuration configuration_of(const RobotOptions& options) {
  std::vector<configuration::Override> overrides;
  for (const std::string& assignment : options.settings) overrides.push_back({assignment});
  std::string buses;
  for (const std::string& bus : options.buses) buses += (buses.empty() ? "" : ",") + bus;
  if (!buses.empty()) overrides.push_back({"hardware.buses=" + buses, "--bus"});
  return load_configuration(options.robot, options.config_file, options.preset, overrides);
}

std::vector<simulation::TimedFault> faults_of(const RobotOptions& options, std::size_t bus_count) {
  std::vector<simulation::TimedFault> faults;
  if (options.hang && !options.faults.empty()) {
    throw UsageError("--fault " + options.faults.front() +
                     ": its time counts from the gantry's release, and with --hang there is none; omit one");
  }
  for (const std::string& text : options.faults) {
    faults.push_back(simulation::parse_fault(text));
    const simulation::TimedFault& fault = faults.back();
    if (fault.bus && *fault.bus >= bus_count) {
      throw UsageError("--fault " + text + ": there is no bus " + std::to_string(*fault.bus) +
                       "; the buses are 0 to " + std::to_string(bus_count - 1));
    }
    if (fault.kind == simulation::FaultKind::disconnect && options.lockstep) {
      throw UsageError("--fault " + text + ": a disconnected bus ends lock-step; omit --lockstep");
    }
  }
  return faults;
}

struct MistakeName {
  const char* name;
  bool robot_on_bus::JointMistake::* mistake;
  const char* description;
};
constexpr MistakeName kMistakes[] = {
    {"motor-reversed", &robot_on_bus::JointMistake::motor_reversed, "its torque acts the other way"},
    {"encoder-reversed", &robot_on_bus::JointMistake::encoder_reversed, "it counts the other way"},
    {"dead", &robot_on_bus::JointMistake::dead, "its motor gives no torque"},
    {"encoder-dead", &robot_on_bus::JointMistake::encoder_dead, "its angle never changes"},
    {"encoder-exchanged", &robot_on_bus::JointMistake::encoder_exchanged,
     "its encoder and that of the leg's other joint are exchanged"},
    {"blocked", &robot_on_bus::JointMistake::blocked, "something holds it"}};

constexpr std::string_view kTorsoLate = "torso-late";
constexpr double kLate_s = 0.05;

void add_mistakes(const RobotOptions& options, robot_on_bus::RobotSetup& setup) {
  for (const std::string& text : options.miswired) {
    const std::string_view all = text;
    if (all == kTorsoLate) {
      setup.torso_sensor_delay_s = kLate_s;
      continue;
    }
    const std::size_t colon = std::min(all.find(':'), all.size() - 1);
    const auto named = std::ranges::find_if(
        kMistakes, [&](const MistakeName& row) { return all.substr(0, colon) == row.name; });
    std::size_t joint = 0;
    while (joint < hal::kJoints && all.substr(colon + 1) != simulation::joint_name(joint)) ++joint;
    if (named == std::end(kMistakes) || joint == hal::kJoints) {
      throw UsageError("--miswired " + text +
                       ": expected NAME:JOINT, such as motor-reversed:knee_L, or torso-late; names are\n" +
                       describe_mistakes());
    }
    setup.mistakes[joint].*named->mistake = true;
    if (setup.mistakes[joint].encoder_exchanged) setup.mistakes[joint ^ 1U].encoder_exchanged = true;
  }
}

}  // namespace

std::string describe_mistakes() {
  std::string text;
  for (const MistakeName& row : kMistakes) {
    char line[120];
    std::snprintf(line, sizeof line, "  %-18s %s\n", row.name, row.description);
    text += line;
  }
  return text + "  torso-late         without a joint: the torso sensor is late by 0.05 s\n";
}

SimulatedHardware simulated_hardware(const RobotOptions& options) {
  check_duration(options.duration_s);
  const configuration::Configuration configured = configuration_of(options);
  SimulatedHardware hardware;
  hardware.robot = &robot_model(configured.hardware.robot);
  hardware.bus_names = configuration::bus_names(configured.hardware);
  robot_on_bus::RobotSetup& setup = hardware.setup;
  setup.wiring = configuration::robot_wiring(configured.hardware, configured.timing.torque_rate_hz);
  setup.bus_count = hardware.bus_names.size();
  for (std::size_t bus = 0; bus < setup.bus_count; ++bus) {
    hardware.fd = hardware.fd || hal::uses_fd(setup.wiring, bus);
  }
  if (setup.wiring.serial_imu) {
    hardware.serial_port = configured.hardware.torso_sensor.serial_port;
    if (options.lockstep) {
      throw UsageError(
          "--lockstep: torso_sensor.device is on a serial port, which has no virtual time; omit "
          "--lockstep, "
          "or take a sensor on a bus");
    }
  }
  setup.torso_sensor_rate_hz = configured.hardware.torso_sensor.rate_hz;
  setup.tick_s = 1.0 / configured.timing.torque_rate_hz;
  for (const std::string& assignment : options.plant_settings) set_plant_option(setup.plant, assignment);
  setup.plant.time_step_s = simulation::time_step_for_tick(setup.plant.time_step_s, setup.tick_s);
  setup.model = simulation::make_plant_model(find_robot(configured.hardware.robot).tree, setup.plant,
                                             configured.reference.base_height_m);
  setup.seed = options.seed;
  const model::RobotConstants& robot = hardware.robot->constants;
  setup.standing = standing_on_ground(setup.plant, {robot.thigh_length_m, robot.shin_length_m}, configured);
  if (options.hang) setup.gantry = robot_on_bus::hanging_for_good();
  if (options.hang && setup.plant.joint_damping_Nms_rad) setup.gantry.rest_damping_Nms_rad = 0.0;
  add_mistakes(options, setup);
  setup.faults = faults_of(options, setup.bus_count);
  for (const std::string& text : options.pushes) setup.pushes.push_back(simulation::parse_push(text));
  simulation::check_pushes(setup.pushes, setup.tick_s);
  setup.keep_samples = !options.report_file.empty() || !options.log_file.empty();
  return hardware;
}

}  // namespace stilt::cli
