#include "mpc_core/solver/terminal_cost.h"

#include <algorithm>

namespace stilt::solver {
namespace {

using model::kAngles;
using model::kFirstAngle;
using model::kFirstJoint;
using model::kInputs;
using model::kJoints;
using model::kPositions;

/// A and B of x' = [v; a_b(x, u); u_j].
void linearise_flow(const model::RobotModel& robot, const model::StateVector& x, const model::InputVector& u,
                    StateMatrix& A, InputMatrix& B) noexcept {
  model::FlowDerivatives<double> flow;
  robot.scalar.flow_derivatives(x.data(), u.data(), flow);
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
  if (solve_care(work.problem, work.solution, work.care) != CareOutcome::kOk) return false;
  for (int c = 0; c < kStates; ++c) {
    for (int r = 0; r < kStates; ++r) data.terminal_weight[c][r] = data.cost.terminal * work.solution.S(r, c);
  }
  return true;
}

}  // namespace stilt::solver
