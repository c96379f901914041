#include "host_tools/gait_synthesis/initial_guess.h"

#include <cmath>

#include "mpc_core/gait/reference.h"
#include "mpc_core/gait/swing.h"

namespace stilt::gait_synthesis {
namespace {

model::PositionVector position_at(const model::RobotConstants& robot, const StepTask& task, double s) {
  constexpr double kHeightShare = 0.92;  // share of the straight leg: slightly bent knees
  const double height_m = kHeightShare * (robot.thigh_length_m + robot.shin_length_m);
  const double pole_1_s = std::sqrt(model::kGravity_m_s2 / height_m);
  const double length_m = task.step_length_m();
  const double swing_m = 1.5 * task.limits.clearance_m;
  const double x_m = 0.5 * length_m * std::sinh(pole_1_s * (s - 0.5) * task.step_time_s) /
                     std::sinh(0.5 * pole_1_s * task.step_time_s);
  const double foot_x_m = gait::minimum_jerk(-length_m, length_m, s, task.step_time_s).position;
  const double foot_z_m =
      gait::swing_height(swing_m, -task.limits.touchdown_speed_min_m_s, s, task.step_time_s).position;
  model::PositionVector q;
  q << x_m, height_m, 0.0, gait::leg_angles(-x_m, -height_m, robot.thigh_length_m, robot.shin_length_m),
      gait::leg_angles(foot_x_m - x_m, foot_z_m - height_m, robot.thigh_length_m, robot.shin_length_m);
  return q;
}

}  // namespace

Eigen::VectorXd initial_guess(const model::RobotConstants& robot, const StepTask& task,
                              const StepProgram& program) {
  constexpr double kMove = 1e-3;
  const Eigen::VectorXd& times = program.node_times();
  Eigen::MatrixXd q(model::kPositions, times.size());
  Eigen::MatrixXd v = q;
  Eigen::MatrixXd a = q;
  for (Eigen::Index k = 0; k < times.size(); ++k) {
    const double h = kMove * task.step_time_s;
    const model::PositionVector here = position_at(robot, task, times[k]);
    const model::PositionVector ahead = position_at(robot, task, times[k] + kMove);
    const model::PositionVector behind = position_at(robot, task, times[k] - kMove);
    q.col(k) = here;
    v.col(k) = (ahead - behind) / (2.0 * h);
    a.col(k) = (ahead - 2.0 * here + behind) / (h * h);
  }
  return program.pack(q, v, a);
}

}  // namespace stilt::gait_synthesis
