#pragma once

#include "mpc_core/gait/hzd_gait.h"
#include "mpc_core/model/robot.h"

namespace stilt::gait_synthesis {

/// Degree of the polynomials in time that describe a motion.
inline constexpr int kMotionDegree = 25;

/// Finds the periodic motion of the hybrid model under the outputs of `gait`, by Newton's method on the
/// return map. It is near `start`, a state just after a touch-down. Writes it to gait.motion: base and joints
/// as polynomials through the Gauss-Lobatto points of the step, torques and forces likewise. Sets step time,
/// step length and speed to the values found; they differ from the given ones only by the error of the
/// collocation. Placement gains must be 0. Throws std::runtime_error when there is no such motion.
void fit_motion(const model::RobotModel& robot, const model::StateVector& start, gait::HzdGait& gait);

/// Sets the placement gains of a gait. They are 0 for a phase by hip position, whose return map is stable
/// without them. For a phase by time they minimise the spectral radius of the linearised return map.
/// They stay 0 where a slightly disturbed step falls, and the answer is false.
[[nodiscard]] bool place_feet(const model::RobotModel& robot, gait::HzdGait& gait);

/// State just after touch-down of gait.motion.
[[nodiscard]] model::StateVector start_of_motion(const gait::HzdGait& gait);

}  // namespace stilt::gait_synthesis
