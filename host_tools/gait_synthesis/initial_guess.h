#pragma once

#include <Eigen/Core>

#include "host_tools/gait_synthesis/step_program.h"

namespace stilt::gait_synthesis {

/// Initial guess of the search: variables of a plain step. The torso is upright at constant height. It
/// moves as a linear inverted pendulum from half a step behind the stance foot to half a step ahead. The
/// swing foot follows a minimum-jerk path; the legs follow by inverse kinematics.
[[nodiscard]] Eigen::VectorXd initial_guess(const model::RobotConstants& robot, const StepTask& task,
                                            const StepProgram& program);

}  // namespace stilt::gait_synthesis
