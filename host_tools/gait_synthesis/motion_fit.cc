#include "host_tools/gait_synthesis/motion_fit.h"

#include <Eigen/LU>
#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "host_tools/gait_synthesis/hybrid_step.h"
#include "host_tools/gait_synthesis/lobatto.h"
#include "host_tools/gait_synthesis/return_map.h"

namespace stilt::gait_synthesis {
namespace {

using model::kJoints;
using model::kPositions;
using model::StateVector;
using Square = Eigen::Matrix<double, kReducedStates, kReducedStates>;

/// Derivative of the state after a step by the shift of the swing hip.
ReducedState shift_effect(const model::RobotModel& robot, const gait::HzdGait& gait,
                          const StateVector& start) {
  constexpr double kMove_rad = 1e-5;
  StepOptions ahead;
  StepOptions behind;
  ahead.shift_rad = kMove_rad;
  behind.shift_rad = -kMove_rad;
  const auto after_ahead = integrate_step(robot, gait, start, ahead);
  const auto after_behind = integrate_step(robot, gait, start, behind);
  if (!after_ahead || !after_behind) return ReducedState::Zero();
  return (reduce(after_ahead->after) - reduce(after_behind->after)) / (2.0 * kMove_rad);
}

/// Gains K of u = -K r that minimise the sum of weight |r|^2 + u^2 under r+ = A r + b u. The Riccati
/// difference equation is iterated until it converges.
ReducedState regulator(const Square& a, const ReducedState& b, double weight) {
  constexpr int kIterations = 2000;
  constexpr double kStill = 1e-13;
  Square p = Square::Identity();
  ReducedState gain = ReducedState::Zero();
  for (int i = 0; i < kIterations; ++i) {
    const ReducedState pb = p * b;
    const ReducedState next = a.transpose() * pb / (1.0 + b.dot(pb));
    p = weight * Square::Identity() + a.transpose() * p * (a - b * next.transpose());
    p = 0.5 * (p + p.transpose()).eval();
    const bool still = (next - gain).cwiseAbs().maxCoeff() < kStill * (1.0 + next.cwiseAbs().maxCoeff());
    gain = next;
    if (still) break;
  }
  return gain;
}

}  // namespace

StateVector start_of_motion(const gait::HzdGait& gait) {
  const gait::GaitPoint start = gait::motion_at(gait, 0.0);
  StateVector x;
  x << start.position, start.velocity;
  return x;
}

void fit_motion(const model::RobotModel& robot, const StateVector& start, gait::HzdGait& gait) {
  const auto fixed_point = find_fixed_point(robot, gait, reduce(start));
  if (!fixed_point) throw std::runtime_error("the outputs give no periodic motion");
  const StateVector first = expand(robot, *fixed_point);
  const auto step = integrate_step(robot, gait, first);
  gait.step_time_s = step->duration_s;
  gait.step_length_m = step->before[0] - step->after[0];
  gait.speed_m_s = gait.step_length_m / gait.step_time_s;
  gait.motion.degree = kMotionDegree;
  const LobattoBasis basis = lobatto_basis(kMotionDegree);
  const auto fit = bernstein_matrix(basis.node, kMotionDegree).fullPivLu();
  const int count = kMotionDegree + 1;
  Eigen::MatrixXd values(count, kPositions + kJoints + 2);
  const std::vector<StateVector> states = states_at(robot, gait, first, gait.step_time_s * basis.node);
  for (int k = 0; k < count; ++k) {
    const StateVector& x = states[static_cast<std::size_t>(k)];
    const StanceMotion motion =
        stance_motion(robot, x, output_feedback(robot, gait, x, gait.step_time_s * basis.node[k], 0.0));
    values.row(k) << x.head<kPositions>().transpose(), motion.torque_Nm.transpose(),
        motion.force_N.transpose();
  }
  const Eigen::MatrixXd coefficients = fit.solve(values);
  for (int i = 0; i < count; ++i) {
    for (int c = 0; c < kPositions; ++c) gait.motion.position[c][i] = coefficients(i, c);
    for (int j = 0; j < kJoints; ++j) gait.motion.torque_Nm[j][i] = coefficients(i, kPositions + j);
    for (int c = 0; c < 2; ++c) gait.motion.force_N[c][i] = coefficients(i, kPositions + kJoints + c);
  }
}

bool place_feet(const model::RobotModel& robot, gait::HzdGait& gait) {
  constexpr double kStateWeight = 1e-3;
  std::fill(std::begin(gait.feedback.placement), std::end(gait.feedback.placement), 0.0);
  if (gait.outputs.phase == gait::PhaseKind::hip_position) return true;
  const StateVector start = start_of_motion(gait);
  const auto free = linearise_return_map(robot, gait, reduce(start));
  if (!free) return false;
  const ReducedState gain = regulator(free->jacobian, shift_effect(robot, gait, start), kStateWeight);
  std::copy(gain.data(), gain.data() + kReducedStates, gait.feedback.placement);
  return true;
}

}  // namespace stilt::gait_synthesis
