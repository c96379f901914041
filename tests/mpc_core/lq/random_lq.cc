#include "tests/mpc_core/lq/random_lq.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstring>

namespace stilt::lq::testing {
namespace {

Matrix gaussian(std::mt19937_64& random, int rows, int columns) {
  std::normal_distribution<double> normal;
  return Matrix::NullaryExpr(rows, columns, [&] { return normal(random); });
}

void write_columns(double (*to)[kRows], const Matrix& from) {
  for (int c = 0; c < from.cols(); ++c) {
    for (int r = 0; r < from.rows(); ++r) to[c][r] = from(r, c);
  }
}

void write(double* to, const Vector& from) { std::copy(from.begin(), from.end(), to); }

Matrix read_columns(const double (*from)[kRows], int columns) {
  return Eigen::Map<const Eigen::Matrix<double, kRows, Eigen::Dynamic>>(&from[0][0], kRows, columns)
      .topRows(kStates);
}

/// Columns whose joints' positions move as those of double integrators, with the rows of the base times
/// `base`.
Matrix double_integrators(Matrix columns, double h, double base) {
  for (const int row : kBaseRow) columns.row(row) *= base;
  const Matrix velocities = columns.bottomRows(model::kJoints);
  columns.middleRows(model::kFirstJoint, model::kJoints) = 0.5 * h * velocities;
  return columns;
}

/// Largest entry of |sum of terms| relative to the sum of |terms| plus one.
double relative(const std::vector<Vector>& terms) {
  if (terms.front().size() == 0) return 0.0;
  Vector total = Vector::Zero(terms.front().size());
  Vector scale = Vector::Ones(terms.front().size());
  for (const Vector& term : terms) {
    total += term;
    scale += term.cwiseAbs();
  }
  const double worst = total.cwiseQuotient(scale).cwiseAbs().maxCoeff();
  return std::isfinite(total.sum()) ? worst : INFINITY;
}

}  // namespace

DenseStage dense(const LqStage& stage) {
  const int m = stage.free_inputs;
  DenseStage out;
  out.A = dense_dynamics(stage);
  out.B = read_columns(stage.B, m);
  out.Q = read_columns(stage.Q, kStates);
  out.S = read_columns(stage.S, m).transpose();
  out.R = Eigen::Map<const Eigen::Matrix<double, kMaxFreeInputs, kMaxFreeInputs>>(&stage.R[0][0])
              .topLeftCorner(m, m);
  out.b = dense_state(stage.b);
  out.q = dense_state(stage.q);
  out.r = Eigen::Map<const Vector>(stage.r, m);
  return out;
}

Matrix baseline_terminal_hessian(const LqTerminal& terminal) { return read_columns(terminal.Q, kStates); }

Vector dense_state(const double* padded) { return Eigen::Map<const Vector>(padded, kStates); }

LqStage random_stage(std::mt19937_64& random, StageKind kind, double coupling) {
  const int m = kind.free_inputs, n = kStates + m;
  const bool flow = kind.form == StageForm::flow;
  LqStage stage{};
  stage.form = kind.form;
  stage.free_inputs = m;
  stage.constraints = kind.constraints;
  stage.h = flow ? std::uniform_real_distribution<double>(0.002, 0.030)(random) : 0.0;
  Matrix G = coupling * gaussian(random, kStates, flow ? kBaseRows + kind.constraints : 7);
  G.row(0).setZero();
  write_columns(stage.G, G);
  write_columns(stage.L, double_integrators(gaussian(random, kStates, kind.constraints), stage.h, 0.0));
  write_columns(stage.B, double_integrators(gaussian(random, kStates, m), stage.h, 1.0));
  const Matrix root = gaussian(random, n, n) / std::sqrt(double(n));
  const Matrix H = root * root.transpose() + 0.01 * Matrix::Identity(n, n);
  write_columns(stage.Q, H.topLeftCorner(kStates, kStates));
  write_columns(stage.S, H.topRightCorner(kStates, m));
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j < m; ++j) stage.R[i][j] = H(kStates + i, kStates + j);
  }
  write(stage.b, gaussian(random, kStates, 1));
  write(stage.q, gaussian(random, kStates, 1));
  write(stage.r, gaussian(random, m, 1));
  return stage;
}

void add_stage(std::mt19937_64& random, StageKind kind, double coupling, LqProblem& problem) {
  std::mt19937_64 separate(problem.stages.size());
  problem.stages.push_back(random_stage(random, kind, coupling));
  std::normal_distribution<double> normal;
  InputProjection inputs;
  std::memset(&inputs, 0xff, sizeof(inputs));
  const auto draw = [&](double* values, int count) {
    std::generate(values, values + count, [&] { return normal(separate); });
  };
  draw(inputs.u0, model::kInputs);
  for (int i = 0; i < kind.constraints; ++i) draw(inputs.Y[i], model::kInputs);
  for (int i = 0; i < kind.free_inputs; ++i) draw(inputs.W[i], model::kInputs);
  inputs.u0_slope = normal(separate);
  inputs.first_force = -1;
  if (kind.free_inputs > 2) {
    inputs.first_force = model::kJoints + (normal(separate) < 0.0 ? 0 : 2);
    for (double(&row)[kRows] : inputs.F) {
      draw(row, kStates);
      std::fill(row + kStates, row + kRows, 0.0);
    }
  }
  problem.inputs.push_back(inputs);
}

LqProblem random_problem(std::uint64_t seed, int count) {
  std::mt19937_64 random(seed);
  const double coupling = std::uniform_real_distribution<double>(0.02, 0.3)(random);
  LqProblem problem;
  for (int k = 0; k < count; ++k) {
    const int choice = std::uniform_int_distribution<int>(0, 3)(random);
    add_stage(random, kKinds[choice], coupling, problem);
  }
  const Matrix root = gaussian(random, kStates, kStates);
  write_columns(problem.terminal.Q, root * root.transpose());
  write(problem.terminal.q, gaussian(random, kStates, 1));
  write(problem.x0, gaussian(random, kStates, 1));
  return problem;
}

SweepStatus backward_sweep(const LqProblem& problem, LqGain* gains, RiccatiWorkspace& workspace,
                           ValueFunction* values) {
  const int count = problem.count();
  BackwardSweep sweep(problem.terminal, workspace);
  if (values != nullptr) values[count] = sweep.value();
  for (int k = count - 1; k >= 0; --k) {
    const LqStage& stage = problem.stages[static_cast<std::size_t>(k)];
    const SweepOutcome outcome = sweep.step(stage, stage, gains[k]);
    if (outcome != SweepOutcome::ok) return {outcome, k};
    if (values != nullptr) values[k] = sweep.value();
  }
  if (!sweep.finite()) return {SweepOutcome::not_finite, 0};
  return {};
}

LqSolution solve(const LqProblem& problem, SweepStatus& status) {
  const int count = problem.count();
  LqSolution solution{std::vector<LqGain>(count), std::vector<ValueFunction>(count + 1),
                      std::vector<LqStep>(count + 1)};
  RiccatiWorkspace workspace;
  std::memset(&workspace, 0xff, sizeof(workspace));  // all NaN: nothing may be read before it is written
  status = backward_sweep(problem, solution.gains.data(), workspace, solution.values.data());
  if (status.ok()) {
    solution.slope =
        forward_sweep(problem.first_orders().data(), problem.inputs.data(), count, problem.terminal,
                      solution.gains.data(), problem.x0, solution.steps.data());
  }
  return solution;
}

KktResidual kkt_residual(const LqProblem& problem, const LqSolution& solution) {
  KktResidual worst;
  const auto state = [&](int k) { return dense_state(solution.steps[k].x); };
  const auto costate = [&](int k) -> Vector {
    const ValueFunction& value = solution.values[k];
    return read_columns(value.P, kStates) * state(k) + dense_state(value.p);
  };
  const int last = problem.count();
  worst.dynamics = relative({state(0), -dense_state(problem.x0)});
  worst.state = relative({baseline_terminal_hessian(problem.terminal) * state(last),
                          dense_state(problem.terminal.q), -costate(last)});
  for (int k = 0; k < last; ++k) {
    const DenseStage s = dense(problem.stages[k]);
    const Vector x = state(k), next = costate(k + 1);
    const Vector w = Eigen::Map<const Vector>(solution.steps[k].w, problem.stages[k].free_inputs);
    worst.state = std::max(
        worst.state, relative({s.Q * x, s.q, s.S.transpose() * w, s.A.transpose() * next, -costate(k)}));
    worst.input = std::max(worst.input, relative({s.R * w, s.r, s.S * x, s.B.transpose() * next}));
    worst.dynamics = std::max(worst.dynamics, relative({s.A * x, s.B * w, s.b, -state(k + 1)}));
  }
  return worst;
}

Vector dense_kkt_solution(const LqProblem& problem) {
  int variables = 0;
  for (const LqStage& stage : problem.stages) variables += stage.free_inputs + kStates;
  const int equations = problem.count() * kStates;
  Matrix kkt = Matrix::Zero(variables + equations, variables + equations);
  Vector right = Vector::Zero(variables + equations);
  int at = 0;  // of w_k; x_k, for k > 0, stands just before it
  for (int k = 0; k < problem.count(); ++k) {
    const DenseStage s = dense(problem.stages[k]);
    const int m = problem.stages[k].free_inputs, row = variables + k * kStates, x = at - kStates;
    const Vector x0 = dense_state(problem.x0);
    kkt.block(at, at, m, m) = s.R;
    right.segment(at, m) = -s.r;
    right.segment(row, kStates) = -s.b;
    kkt.block(row, at, kStates, m) = s.B;
    kkt.block(row, at + m, kStates, kStates) = -Matrix::Identity(kStates, kStates);
    if (k == 0) {
      right.segment(at, m) -= s.S * x0;
      right.segment(row, kStates) -= s.A * x0;
    } else {
      kkt.block(x, x, kStates, kStates) = s.Q;
      right.segment(x, kStates) = -s.q;
      kkt.block(at, x, m, kStates) = s.S;
      kkt.block(x, at, kStates, m) = s.S.transpose();
      kkt.block(row, x, kStates, kStates) = s.A;
    }
    at += m + kStates;
  }
  kkt.block(variables - kStates, variables - kStates, kStates, kStates) =
      baseline_terminal_hessian(problem.terminal);
  right.segment(variables - kStates, kStates) = -dense_state(problem.terminal.q);
  kkt.topRightCorner(variables, equations) = kkt.bottomLeftCorner(equations, variables).transpose().eval();
  return kkt.partialPivLu().solve(right).head(variables);
}

}  // namespace stilt::lq::testing
