#include "mpc_core/sqp/terminal_cost.h"

#include <algorithm>

#include "mpc_core/lq/small_solve.h"

namespace stilt::sqp {
namespace {

using lq::kRows;
using model::kAngles;
using model::kFirstAngle;
using model::kFirstJoint;
using model::kInputs;
using model::kJoints;
using model::kPositions;
using model::kStates;

/// Computes A and B of x' = [v; a_b(x, u); u_j].
void linearise_flow(const model::RobotModel& robot, const model::StateVector& x, const model::InputVector& u,
                    lq::StateMatrix& A, lq::InputMatrix& B) noexcept {
  model::FlowDerivatives<double> flow;
  robot.flow_derivatives(x.data(), u.data(), flow);
  A.setZero();
  B.setZero();
  for (int i = 0; i < kPositions; ++i) A(i, kPositions + i) = 1.0;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < kAngles; ++c) {
      A(kPositions + r, kFirstAngle + c) = flow.base_acceleration_dtheta[r][c];
      A(kPositions + r, kPositions + kFirstAngle + c) = flow.base_acceleration_domega[r][c];
    }
    for (int c = 0; c < kInputs; ++c) B(kPositions + r, c) = flow.base_acceleration_du[r][c];
  }
  for (int j = 0; j < kJoints; ++j) B(kPositions + kFirstJoint + j, j) = 1.0;
}

/// Adds the foot terms of the running cost, 1/2 sum over feet of e' W e, to the weights of state, input and
/// both. They are those of 1/2 (x'Q x + 2 x'N u + u'R u). e holds position, velocity and acceleration of the
/// foot.
void add_foot_weights(const ocp::ProblemData& data, const model::StateVector& x, const model::InputVector& u,
                      lq::CareProblem& problem, CrossWeight& N) noexcept {
  model::NodeDerivatives<double> node;
  data.robot->node_derivatives(x.data(), u.data(), data.joint_parameters, node);
  for (int i = 0; i < 2 * model::kFeet; ++i) {
    model::StateVector position = model::StateVector::Zero();
    model::StateVector velocity = model::StateVector::Zero();
    model::StateVector acceleration = model::StateVector::Zero();
    position[i % 2] = 1.0;
    velocity[kPositions + i % 2] = 1.0;
    for (int c = 0; c < model::kChain; ++c) {
      const int angle = kFirstAngle + model::kChainAngles[i / 2][c];
      position[angle] = node.foot_position_dchain[i][c];
      velocity[angle] = node.foot_velocity_dchain[i][c];
      velocity[kPositions + angle] = node.foot_position_dchain[i][c];
    }
    for (int c = 0; c < kAngles; ++c) {
      acceleration[kFirstAngle + c] = node.foot_acceleration_dtheta[i][c];
      acceleration[kPositions + kFirstAngle + c] = node.foot_acceleration_domega[i][c];
    }
    const Eigen::Map<const model::InputVector> by_input(node.foot_acceleration_du[i]);
    const double weight = data.cost.foot_acceleration;
    problem.Q += data.cost.foot_position * position.lazyProduct(position.transpose());
    problem.Q += data.cost.foot_velocity * velocity.lazyProduct(velocity.transpose());
    problem.Q += weight * acceleration.lazyProduct(acceleration.transpose());
    problem.R += weight * by_input.lazyProduct(by_input.transpose());
    N += weight * acceleration.lazyProduct(by_input.transpose());
  }
}

/// Completes the square: with u = v - R^-1 N'x the cost has no product of state and input. False when R is
/// singular.
[[nodiscard]] bool remove_cross_weight(const CrossWeight& N, lq::CareProblem& problem) noexcept {
  lq::InputWeight R = problem.R;
  lq::FeedbackMatrix shift = N.transpose();
  if (!lq::solve_in_place(R, shift)) return false;
  problem.A -= problem.B.lazyProduct(shift);
  problem.Q -= N.lazyProduct(shift);
  problem.Q = (0.5 * (problem.Q + problem.Q.transpose())).eval();
  return true;
}

}  // namespace

bool set_terminal_cost(ocp::ProblemData& data, const model::StateVector& standing,
                       TerminalCostWorkspace& work) noexcept {
  std::fill(&data.terminal_weight[0][0], &data.terminal_weight[0][0] + kStates * kRows, 0.0);
  if (data.cost.terminal == 0.0) return true;
  model::InputVector u = model::InputVector::Zero();
  const double weight_N = data.robot->constants.total_mass_kg * model::kGravity_m_s2;
  u[kJoints + 1] = 0.5 * weight_N;
  u[kJoints + 3] = 0.5 * weight_N;
  linearise_flow(*data.robot, standing, u, work.problem.A, work.problem.B);
  work.problem.Q.setZero();
  work.problem.R.setZero();
  for (int i = 0; i < kStates; ++i) work.problem.Q(i, i) = data.state_weight[i];
  for (int i = 0; i < kInputs; ++i) work.problem.R(i, i) = data.input_weight[i];
  if (data.cost.terminal_feet) {
    work.cross.setZero();
    add_foot_weights(data, standing, u, work.problem, work.cross);
    if (!remove_cross_weight(work.cross, work.problem)) return false;
  }
  if (lq::solve_care(work.problem, work.solution, work.care) != lq::CareOutcome::ok) return false;
  for (int c = 0; c < kStates; ++c) {
    for (int r = 0; r < kStates; ++r) data.terminal_weight[c][r] = data.cost.terminal * work.solution.S(r, c);
  }
  return true;
}

}  // namespace stilt::sqp
