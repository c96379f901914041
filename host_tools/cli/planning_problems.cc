#include "host_tools/cli/planning_problems.h"

#include "host_tools/cli/progress.h"
#include "host_tools/simulation/closed_loop/closed_loop.h"
#include "host_tools/simulation/plant/simulated_robot.h"

namespace stilt::cli {
namespace {

constexpr std::int64_t kLead_ns = 3'000'000'000;

}  // namespace

bool walk(const ControllerChoice& choice, const Walk& walk, simulation::SimulatedController& controller,
          const PlanObserver& observer) {
  const model::RobotModel& robot = robot_model(choice.robot);
  const control::ControllerParameters parameters = controller_parameters(choice);
  simulation::PlantOptions world = walk.world;
  world.time_step_s =
      simulation::time_step_for_tick(world.time_step_s, 1.0 / parameters.timing.torque_rate_hz);
  simulation::Plant plant(
      simulation::make_plant_model(find_robot(choice.robot).tree, world, parameters.reference.base_height_m),
      world, 1);
  const control_loop::PlanTiming timing(parameters.timing);
  simulation::RunSettings settings;
  settings.duration_s =
      1e-9 * static_cast<double>(walk.plans * timing.period_ticks * static_cast<long long>(timing.tick_ns));
  settings.leg = {robot.constants.thigh_length_m, robot.constants.shin_length_m};
  settings.initial_state = simulation::standing_state(settings.leg, parameters.reference.base_height_m,
                                                      parameters.gait.stand_half_width_m);
  settings.commands = {{0.0, {gait::GaitKind::walk, walk.speed_m_s}}};
  settings.pushes = walk.pushes;
  settings.keep_samples = false;
  Progress progress("walking", settings.duration_s, "s");
  settings.progress = [&](double time_s) { progress.update(time_s); };
  settings.observer.plans = [&](double) {
    observer.before();
    return true;
  };
  settings.observer.planned = [&](const control_loop::PlanningRequest& request, const sqp::SolveReport&) {
    observer.after({request.time_s, request.state, request.command, request.tracked});
  };
  return simulation::run_closed_loop(plant, controller, settings).summary.survived;
}

PlanningProblems record_walk(const ControllerChoice& choice, double speed_m_s, int count) {
  const configuration::Configuration configuration = controller_configuration(choice);
  const auto controller = make_controller(controller_setup(choice, robot_model(choice.robot), configuration));
  const control_loop::PlanTiming timing(configuration.timing);
  const auto lead = static_cast<int>(kLead_ns / (timing.period_ticks * timing.tick_ns));
  PlanningProblems problems;
  problems.lead = static_cast<std::size_t>(lead);
  PlanObserver recorder;
  recorder.after = [&](const control::PlannerInput& input) { problems.inputs.push_back(input); };
  problems.survived = walk(choice, {.speed_m_s = speed_m_s, .plans = lead + count}, *controller, recorder);
  return problems;
}

}  // namespace stilt::cli
