#pragma once

#include <Eigen/Core>

#include "host_tools/gait_synthesis/step_program.h"

namespace stilt::gait_synthesis {

/// Variables of a plain step to start the search from: torso upright at constant height, moving as a linear
/// inverted pendulum from half a step behind the stance foot to half a step ahead; the swing foot on a
/// minimum-jerk path; legs by inverse kinematics.
[[nodiscard]] Eigen::VectorXd initial_guess(const model::RobotConstants& robot, const StepTask& task,
                                            const StepProgram& program);

}  // namespace stilt::gait_synthesis
