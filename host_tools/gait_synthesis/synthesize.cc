#include "host_tools/gait_synthesis/synthesize.h"

#include <cmath>

#include "host_tools/gait_synthesis/first_guess.h"
#include "host_tools/gait_synthesis/motion_fit.h"

namespace stilt::gait_synthesis {

gait::PhaseKind phase_for_speed(double speed_m_s) {
  return std::abs(speed_m_s) < kSlowestByHip_m_s ? gait::PhaseKind::time : gait::PhaseKind::hip_position;
}

Synthesis synthesize(const model::RobotModel& robot, const StepTask& task, const Eigen::VectorXd* warm) {
  const StepProgram program(robot, task);
  const Eigen::VectorXd start = warm != nullptr ? *warm : first_guess(robot.constants, task, program);
  const IpoptSolution solution = solve(program, start, {});
  if (!solution.solved) {
    throw NoGait("no gait at " + std::to_string(task.speed_m_s) + " m/s: " + solution.status +
                 "; try another step time, or wider limits of torque, pitch or return map");
  }
  Synthesis result;
  result.gait.speed_m_s = task.speed_m_s;
  result.gait.step_time_s = task.step_time_s;
  result.gait.step_length_m = task.step_length_m();
  result.gait.outputs = program.outputs(solution.v);
  fit_motion(robot, program.start_state(solution.v), result.gait);
  place_feet(robot, result.gait);
  result.cost_kind = task.cost;
  const double length_m = std::abs(task.step_length_m());
  result.cost_per_m = solution.cost * task.step_time_s / (length_m > 0.0 ? length_m : 1.0);
  result.iterations = solution.iterations;
  result.solution = solution.v;
  return result;
}

}  // namespace stilt::gait_synthesis
