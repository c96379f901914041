#include "tests/closed_loop/simulated_run.h"

#include <cstdio>
#include <stdexcept>

#include "firmware/configuration/gaits/shipped_gaits.h"
#include "firmware/robots/robots.h"
#include "host_tools/simulation/plant/simulated_robot.h"
#include "host_tools/simulation/plant/stance.h"

namespace stilt::testing_support {
namespace {

simulation::PlantOptions plant_options(const RunRequest& request, const control::TimingParameters& timing) {
  simulation::PlantOptions options;
  for (const std::string& assignment : request.plant) simulation::set_plant_option(options, assignment);
  options.time_step_s = simulation::time_step_for_tick(options.time_step_s, 1.0 / timing.torque_rate_hz);
  return options;
}

simulation::ControllerSetup controller_setup(const RunRequest& request, const model::RobotModel& robot,
                                             const configuration::Configuration& configuration) {
  simulation::ControllerSetup setup;
  setup.robot = &robot;
  setup.parameters = configuration;
  setup.supervision = configuration.supervisor;
  auto gaits = std::make_shared<gait::GaitLibrary>();
  const bool shipped = gait_files::load_shipped_library(request.robot, *gaits).has_value();
  if (shipped && configuration.supervisor.track_gait) setup.fallback_gaits = gaits;
  if (shipped && request.follow_gaits) setup.reference_gaits = gaits;
  return setup;
}

simulation::Plant make_plant(const RunRequest& request, const control::ControllerParameters& parameters) {
  const simulation::PlantOptions options = plant_options(request, parameters.timing);
  const simulation::PlantModel model = simulation::make_plant_model(
      robots::find(request.robot).value()->tree, options, parameters.reference.base_height_m);
  return {model, options, request.seed};
}

}  // namespace

configuration::Configuration parameters_of(const RunRequest& request) {
  std::vector<configuration::Override> overrides;
  overrides.push_back({"discretisation.horizon_s=" + std::to_string(request.horizon_s)});
  for (const std::string& assignment : request.settings) overrides.push_back({assignment});
  const configuration::Result result = configuration::load_robot(request.robot, overrides, request.preset);
  if (!result) throw std::runtime_error(configuration::to_string(result.error().front()));
  return *result;
}

SimulatedRun::SimulatedRun(const RunRequest& request)
    : robot(robots::find(request.robot).value()->model),
      parameters(parameters_of(request)),
      controller(std::make_unique<simulation::SimulatedController>()),
      plant(make_plant(request, parameters)) {
  if (controller->configure(controller_setup(request, robot, parameters)) != control::ConfigureStatus::ok) {
    throw std::runtime_error("the planner refuses the configuration");
  }
  const double half_width_m = parameters.gait.stand_half_width_m;
  settings.duration_s = request.duration_s;
  settings.leg = {robot.constants.thigh_length_m, robot.constants.shin_length_m};
  settings.initial_state =
      simulation::standing_state(settings.leg, parameters.reference.base_height_m, half_width_m,
                                 {plant.ground_height_m(half_width_m), plant.ground_height_m(-half_width_m)});
  settings.commands = request.commands;
  settings.pushes = request.pushes;
  settings.use_true_state = request.use_true_state;
  settings.keep_samples = request.keep_samples;
}

RunRequest walking(double speed_m_s, double horizon_s, double duration_s) {
  RunRequest request;
  request.horizon_s = horizon_s;
  request.commands = {{0.0, {gait::GaitKind::walk, speed_m_s}}};
  request.duration_s = duration_s;
  return request;
}

std::string describe(const SimulatedRun& run, const log::RunRecord& record) {
  const log::RunSummary& summary = record.summary;
  char text[200];
  std::snprintf(text, sizeof text, "%s at %.3f s; mean speed %.3f m/s, %zu steps of %.3f to %.3f m",
                simulation::fall_text(run.plant.fall()), summary.duration_s, summary.mean_speed_m_s,
                summary.steps.size(), summary.step_length_min_m, summary.step_length_max_m);
  return text;
}

}  // namespace stilt::testing_support
