#include "host_tools/benchmark/walking_planner.h"

#include <stdexcept>

#include "mpc_core/gait/reference.h"

namespace stilt::benchmark {
namespace {

constexpr double kPeriod_s = 0.01;
constexpr int kPlans = 120;

}  // namespace

WalkingPlanner::WalkingPlanner(double horizon_s, const model::RobotModel& robot, model::InstructionSet set) {
  control::ControllerParameters parameters;
  parameters.discretisation.horizon_s = horizon_s;
  parameters.sqp.early_stop = false;
  parameters.sqp.instruction_set = set;
  if (planner->configure(robot, parameters) != control::ConfigureStatus::ok) {
    throw std::runtime_error("WalkingPlanner: the planner refuses horizon or instruction set");
  }
  planner->planner().reset(0.0);
  input.state =
      gait::standing_state(robot.constants, parameters.reference.base_height_m,
                           parameters.reference.base_pitch_rad, parameters.gait.stand_half_width_m, true);
  input.command = {gait::GaitKind::walk, 0.5};
  bool usable = planner->planner().plan(input, *plan).usable();
  for (int i = 0; i < kPlans && usable; ++i) usable = plan_next().usable();
  if (!usable) throw std::runtime_error("WalkingPlanner: a plan failed");
}

sqp::SolveReport WalkingPlanner::plan_next() noexcept {
  input.time_s += kPeriod_s;
  input.state = control::interpolate(*plan, input.time_s).state;
  return planner->planner().plan(input, *plan);
}

}  // namespace stilt::benchmark
