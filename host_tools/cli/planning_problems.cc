#include "host_tools/cli/planning_problems.h"

#include "host_tools/cli/progress.h"
#include "host_tools/simulator/closed_loop.h"
#include "host_tools/simulator/simulated_robot.h"

namespace stilt::cli {
namespace {

/// A controller that remembers what its planner was asked.
class RecordingController final : public simulator::Controller {
 public:
  RecordingController(simulator::Controller& controller, std::vector<control::PlannerInput>& inputs)
      : controller_(controller), inputs_(inputs) {}

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
    inputs_.push_back({time_s, state_, command});
    return controller_.plan(time_s, command);
  }

  void adopt_plan() override { controller_.adopt_plan(); }
  [[nodiscard]] const control::Plan& newest_plan() const override { return controller_.newest_plan(); }
  [[nodiscard]] const control::Plan& plan_in_use() const override { return controller_.plan_in_use(); }
  [[nodiscard]] std::size_t bytes() const override { return controller_.bytes(); }

 private:
  simulator::Controller& controller_;
  std::vector<control::PlannerInput>& inputs_;
  model::StateVector state_ = model::StateVector::Zero();
};

}  // namespace

PlanningProblems record_walk(const std::string& robot_name, const control::ControllerParameters& parameters,
                             double speed_m_s, int count) {
  const model::RobotModel& robot = robot_model(robot_name);
  const auto controller = make_controller(robot, parameters);
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
  Progress progress("recording planning problems", settings.duration_s, "s");
  settings.progress = [&](double time_s) { progress.update(time_s); };
  PlanningProblems problems;
  RecordingController recording(*controller, problems.inputs);
  problems.survived = simulator::run_closed_loop(plant, recording, settings).summary.survived;
  return problems;
}

}  // namespace stilt::cli
