#include "host_tools/cli/planning_problems.h"

#include "host_tools/cli/progress.h"
#include "host_tools/simulator/closed_loop.h"
#include "host_tools/simulator/simulated_robot.h"

namespace stilt::cli {
namespace {

/// A controller whose plans are observed.
class ObservedController final : public simulator::Controller {
 public:
  ObservedController(simulator::Controller& controller, const PlanObserver& observer)
      : controller_(controller), observer_(observer) {}

  void reset(const model::StateVector& state, double time_s) override {
    state_ = state;
    controller_.reset(state, time_s);
  }

  simulator::TickOutput tick(const control::SensorReading& reading,
                             const model::StateVector* true_state) override {
    const simulator::TickOutput output = controller_.tick(reading, true_state);
    state_ = output.estimated_state;
    return output;
  }

  std::optional<solver::SolveReport> plan(double time_s, const gait::GaitCommand& command) override {
    observer_.before();
    const std::optional<solver::SolveReport> report = controller_.plan(time_s, command);
    if (report) observer_.after({time_s, state_, command}, *report);
    return report;
  }

  void adopt_plan() override { controller_.adopt_plan(); }
  [[nodiscard]] const control::Plan& newest_plan() const override { return controller_.newest_plan(); }
  [[nodiscard]] const control::Plan& plan_in_use() const override { return controller_.plan_in_use(); }
  [[nodiscard]] std::size_t bytes() const override { return controller_.bytes(); }

 private:
  simulator::Controller& controller_;
  const PlanObserver& observer_;
  model::StateVector state_ = model::StateVector::Zero();
};

}  // namespace

bool walk(const std::string& robot_name, const control::ControllerParameters& parameters, double speed_m_s,
          int count, simulator::Controller& controller, const PlanObserver& observer) {
  const model::RobotModel& robot = robot_model(robot_name);
  simulator::PlantOptions world;
  world.time_step_s =
      simulator::time_step_for_tick(world.time_step_s, 1.0 / parameters.timing.torque_rate_hz);
  simulator::Plant plant(simulator::make_plant_model(simulator::simulated_robot(robot_name), world,
                                                     parameters.reference.base_height_m),
                         world, 1);
  const simulator::TickSchedule schedule(parameters.timing);
  simulator::RunSettings settings;
  settings.duration_s = count * schedule.plan_period_ticks * schedule.tick_s;
  settings.leg = {robot.constants.thigh_length_m, robot.constants.shin_length_m};
  settings.initial_state = simulator::standing_state(settings.leg, parameters.reference.base_height_m,
                                                     parameters.gait.stand_half_width_m);
  settings.commands = {{0.0, {gait::GaitKind::walk, speed_m_s}}};
  settings.timing = parameters.timing;
  settings.keep_samples = false;
  Progress progress("walking", settings.duration_s, "s");
  settings.progress = [&](double time_s) { progress.update(time_s); };
  ObservedController observed(controller, observer);
  return simulator::run_closed_loop(plant, observed, settings).summary.survived;
}

PlanningProblems record_walk(const std::string& robot, const control::ControllerParameters& parameters,
                             double speed_m_s, int count) {
  const auto controller = make_controller(robot_model(robot), parameters);
  PlanningProblems problems;
  PlanObserver recorder;
  recorder.after = [&](const control::PlannerInput& input, const solver::SolveReport&) {
    problems.inputs.push_back(input);
  };
  problems.survived = walk(robot, parameters, speed_m_s, count, *controller, recorder);
  return problems;
}

}  // namespace stilt::cli
