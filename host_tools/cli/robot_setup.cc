#include "host_tools/cli/robot_setup.h"

#include <algorithm>
#include <variant>

#include "firmware/configuration/configuration.h"
#include "hal/robot/wiring_load.h"
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

void check_numbers(const RobotOptions& options) {
  if (options.seed < 0) {
    throw UsageError("--seed " + std::to_string(options.seed) + ": the seed must not be negative");
  }
  if (options.duration_s && !(*options.duration_s > 0.0)) {
    throw UsageError("--duration " + simulation::number_text(*options.duration_s) +
                     ": the duration must be above 0 s");
  }
}

}  // namespace

SimulatedHardware simulated_hardware(const RobotOptions& options) {
  check_numbers(options);
  const configuration::Configuration configured = configuration_of(options);
  SimulatedHardware hardware;
  hardware.robot = &robot_model(configured.hardware.robot);
  hardware.bus_names = configuration::bus_names(configured.hardware);
  robot_on_bus::RobotSetup& setup = hardware.setup;
  setup.wiring = configuration::robot_wiring(configured.hardware);
  setup.bus_count = hardware.bus_names.size();
  for (std::size_t bus = 0; bus < setup.bus_count; ++bus) {
    hardware.fd = hardware.fd || hal::uses_fd(setup.wiring, bus);
  }
  setup.base_rate_hz = configured.hardware.torso_sensor.rate_hz;
  setup.wiring.channel_period_ticks =
      configuration::base_period_ticks(configured.hardware, configured.timing.torque_rate_hz);
  setup.tick_s = 1.0 / configured.timing.torque_rate_hz;
  for (const std::string& assignment : options.plant_settings) set_plant_option(setup.plant, assignment);
  setup.plant.time_step_s = simulation::time_step_for_tick(setup.plant.time_step_s, setup.tick_s);
  setup.model = simulation::make_plant_model(find_robot(configured.hardware.robot).tree, setup.plant,
                                             configured.reference.base_height_m);
  setup.seed = static_cast<std::uint64_t>(options.seed);
  const model::RobotConstants& robot = hardware.robot->constants;
  setup.standing = standing_on_ground(setup.plant, {robot.thigh_length_m, robot.shin_length_m}, configured);
  setup.faults = faults_of(options, setup.bus_count);
  for (const std::string& text : options.pushes) setup.pushes.push_back(simulation::parse_push(text));
  simulation::check_pushes(setup.pushes);
  setup.keep_samples = !options.report_file.empty() || !options.log_file.empty();
  return hardware;
}

}  // namespace stilt::cli
