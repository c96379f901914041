#include "tests/benchmarks/baseline_linearise.h"

#include <Eigen/QR>
#include <cmath>

namespace stilt::benchmark {
namespace {

using model::kAngles;
using model::kFeet;
using model::kFirstAngle;
using model::kFirstJoint;
using model::kInputs;
using model::kJoints;
using model::kPositions;
using model::kStates;

constexpr int kVariables = kStates + kInputs;  ///< of a stage: [dx; du]
constexpr int kDenseRows = 3 * 2 * kFeet + kJoints;

using Row = Eigen::Matrix<double, 1, kVariables>;
using Hessian = Eigen::Matrix<double, kVariables, kVariables>;
using Gradient = Eigen::Matrix<double, kVariables, 1>;
template <int kRows>
using Rows = Eigen::Matrix<double, kRows, kVariables>;
using Dynamics = Eigen::Matrix<double, kStates, kVariables>;

/// A quantity's derivatives by theta, omega and u as a row over [x; u].
Row full_row(const double (&theta)[kAngles], const double (&omega)[kAngles], const double (&input)[kInputs]) {
  Row row = Row::Zero();
  for (int c = 0; c < kAngles; ++c) {
    row[kFirstAngle + c] = theta[c];
    row[kPositions + kFirstAngle + c] = omega[c];
  }
  for (int c = 0; c < kInputs; ++c) row[kStates + c] = input[c];
  return row;
}

Row position_row(const model::NodeDerivatives<double>& node, int i) {
  Row row = Row::Zero();
  row[i % 2] = 1.0;
  for (int c = 0; c < model::kChain; ++c) {
    row[kFirstAngle + model::kChainAngles[i / 2][c]] = node.foot_position_dchain[i][c];
  }
  return row;
}

Row velocity_row(const model::NodeDerivatives<double>& node, int i) {
  Row row = Row::Zero();
  row[kPositions + i % 2] = 1.0;
  for (int c = 0; c < model::kChain; ++c) {
    const int angle = kFirstAngle + model::kChainAngles[i / 2][c];
    row[angle] = node.foot_velocity_dchain[i][c];
    row[kPositions + angle] = node.foot_position_dchain[i][c];
  }
  return row;
}

Row acceleration_row(const model::NodeDerivatives<double>& node, int i) {
  return full_row(node.foot_acceleration_dtheta[i], node.foot_acceleration_domega[i],
                  node.foot_acceleration_du[i]);
}

struct Slope {
  double first;
  double second;
};

Slope barrier(const ocp::BarrierParameters& p, double h) {
  if (h > p.width) return {-p.weight / h, p.weight / (h * h)};
  return {p.weight / (p.width * p.width) * (h - 2.0 * p.width), p.weight / (p.width * p.width)};
}

/// Adds a barrier on lower <= z_i <= upper, or on any value with a row of its own.
Slope limits(const ocp::BarrierParameters& p, double value, double lower, double upper) {
  const Slope above = barrier(p, value - lower);
  const Slope below = barrier(p, upper - value);
  return {above.first - below.first, above.second + below.second};
}

/// x' = [v; a_b; u_j] with its derivatives.
void flow_of(const model::RobotModel& robot, const double* x, const double* u, model::StateVector& rate,
             Dynamics& by) {
  model::FlowDerivatives<double> flow;
  robot.flow_derivatives(x, u, flow);
  by.setZero();
  for (int i = 0; i < kPositions; ++i) {
    rate[i] = x[kPositions + i];
    by(i, kPositions + i) = 1.0;
  }
  for (int r = 0; r < 3; ++r) {
    rate[kPositions + r] = flow.base_acceleration[r];
    by.row(kPositions + r) = full_row(flow.base_acceleration_dtheta[r], flow.base_acceleration_domega[r],
                                      flow.base_acceleration_du[r]);
  }
  for (int j = 0; j < kJoints; ++j) {
    rate[kPositions + kFirstJoint + j] = u[j];
    by(kPositions + kFirstJoint + j, kStates + j) = 1.0;
  }
}

/// One step of Heun's method, [A B] and the state reached.
void heun(const model::RobotModel& robot, const double* x, const double* u, double h, Dynamics& step,
          model::StateVector& reached) {
  const Eigen::Map<const model::StateVector> start(x);
  model::StateVector rate[2];
  Dynamics by[2];
  flow_of(robot, x, u, rate[0], by[0]);
  const model::StateVector middle = start + h * rate[0];
  flow_of(robot, middle.data(), u, rate[1], by[1]);
  Dynamics through = by[1];
  through.noalias() += h * by[1].leftCols<kStates>() * by[0];
  step = 0.5 * h * (by[0] + through);
  step.leftCols<kStates>() += Eigen::Matrix<double, kStates, kStates>::Identity();
  reached = start + 0.5 * h * (rate[0] + rate[1]);
}

/// One stage with its node function evaluated.
struct BaselineStageData {
  const ocp::ProblemData& data;
  const ocp::StageBatch& batch;
  int lane;
  const double* x;
  const double* u;
  model::NodeDerivatives<double> node;

  [[nodiscard]] double value(const ocp::Batch& of) const { return of[static_cast<std::size_t>(lane)]; }
};

void add_cost(const BaselineStageData& s, Hessian& H, Gradient& g) {
  const ocp::ProblemData& data = s.data;
  const auto& p = data.inequality;
  for (int i = 0; i < kStates; ++i) {
    H(i, i) += data.state_weight[i];
    g[i] += data.state_weight[i] * (s.x[i] - s.value(s.batch.x_ref[i]));
  }
  for (int i = 0; i < kInputs; ++i) {
    H(kStates + i, kStates + i) += data.input_weight[i];
    g[kStates + i] += data.input_weight[i] * (s.u[i] - s.value(s.batch.u_ref[i]));
  }
  for (int j = 0; j < kJoints; ++j) {
    const int q = kFirstJoint + j;
    const int v = kPositions + q;
    const Slope position =
        limits(p.joint_position, s.x[q], data.limits.position_min_rad[j], data.limits.position_max_rad[j]);
    const double limit = data.limits.velocity_rad_s[j];
    const Slope velocity = limits(p.joint_velocity, s.x[v], -limit, limit);
    g[q] += position.first;
    H(q, q) += position.second;
    g[v] += velocity.first;
    H(v, v) += velocity.second;
  }
  Rows<kDenseRows> rows;
  Eigen::Matrix<double, kDenseRows, 1> slope;
  Eigen::Matrix<double, kDenseRows, 1> curvature;
  int row = 0;
  const auto add = [&](const Row& by, double first, double second) {
    rows.row(row) = by;
    slope[row] = first;
    curvature[row++] = second;
  };
  for (int i = 0; i < 2 * kFeet; ++i) {
    const auto squared = [&](double weight, double error, const Row& by) { add(by, weight * error, weight); };
    squared(data.cost.foot_position, s.node.foot_position[i] - s.value(s.batch.foot_position_ref[i]),
            position_row(s.node, i));
    squared(data.cost.foot_velocity, s.node.foot_velocity[i] - s.value(s.batch.foot_velocity_ref[i]),
            velocity_row(s.node, i));
    squared(data.cost.foot_acceleration,
            s.node.foot_acceleration[i] - s.value(s.batch.foot_acceleration_ref[i]),
            acceleration_row(s.node, i));
  }
  for (int j = 0; j < kJoints; ++j) {
    const double limit = data.limits.torque_Nm[j];
    const Slope torque = limits(p.joint_torque, s.node.joint_torque[j], -limit, limit);
    add(full_row(s.node.joint_torque_dtheta[j], s.node.joint_torque_domega[j], s.node.joint_torque_du[j]),
        torque.first, torque.second);
  }
  H.noalias() += rows.transpose() * curvature.asDiagonal() * rows;
  g.noalias() += rows.transpose() * slope;
  for (int foot = 0; foot < kFeet; ++foot) {
    if (!s.batch.mode[foot]) continue;
    const int x = kStates + kJoints + 2 * foot;
    const int z = x + 1;
    const double mu = p.friction_coefficient;
    const double margin = mu * (s.u[z - kStates] - data.minimum_normal_force_N(s.batch.mode));
    const Slope front = barrier(p.friction, margin - s.u[x - kStates]);
    const Slope back = barrier(p.friction, margin + s.u[x - kStates]);
    g[x] += back.first - front.first;
    g[z] += mu * (back.first + front.first);
    H(x, x) += back.second + front.second;
    H(z, z) += mu * mu * (back.second + front.second);
    H(x, z) += mu * (back.second - front.second);
    H(z, x) += mu * (back.second - front.second);
  }
}

/// Equality rows c [dx; du] + e = 0.
template <int kRows>
void constraint_rows(const BaselineStageData& s, Rows<kRows>& c, Eigen::Matrix<double, kRows, 1>& e) {
  const ocp::EqualityParameters& p = s.data.equality;
  int row = 0;
  for (int foot = 0; foot < kFeet; ++foot) {
    const int x = 2 * foot;
    const int z = x + 1;
    if (s.batch.mode[foot]) {
      for (const int i : {x, z}) {
        c.row(row) = acceleration_row(s.node, i) + p.stance_kd_1_s * velocity_row(s.node, i);
        e[row++] = s.node.foot_acceleration[i] + p.stance_kd_1_s * s.node.foot_velocity[i];
      }
      continue;
    }
    c.row(row) = acceleration_row(s.node, z) + p.swing_kd_1_s * velocity_row(s.node, z) +
                 p.swing_kp_1_s2 * position_row(s.node, z);
    e[row++] = s.node.foot_acceleration[z] - s.value(s.batch.foot_acceleration_ref[z]) +
               p.swing_kd_1_s * (s.node.foot_velocity[z] - s.value(s.batch.foot_velocity_ref[z])) +
               p.swing_kp_1_s2 * (s.node.foot_position[z] - s.value(s.batch.foot_position_ref[z]));
    for (const int i : {x, z}) {
      c.row(row).setZero();
      c(row, kStates + kJoints + i) = 1.0;
      e[row++] = s.u[kJoints + i];
    }
  }
}

/// du = u0 + X dx + W w by D' = Q R, then the model in (dx, w).
template <int kRows>
void project(const BaselineStageData& s, const Hessian& H, const Gradient& g, const Dynamics& step,
             const model::StateVector& defect, double h, BaselineModel& out) {
  constexpr int kFree = kInputs - kRows;
  Rows<kRows> c;
  Eigen::Matrix<double, kRows, 1> e;
  constraint_rows<kRows>(s, c, e);
  const Eigen::Matrix<double, kInputs, kRows> D = c.template rightCols<kInputs>().transpose();
  const Eigen::HouseholderQR<Eigen::Matrix<double, kInputs, kRows>> qr(D);
  const Eigen::Matrix<double, kInputs, kInputs> orthogonal = qr.householderQ();
  const Eigen::Matrix<double, kRows, kRows> lower =
      qr.matrixQR().template topRows<kRows>().template triangularView<Eigen::Upper>().transpose();
  const auto range = orthogonal.template leftCols<kRows>();
  const Eigen::Matrix<double, kInputs, kFree> W = orthogonal.template rightCols<kFree>();
  const Eigen::Matrix<double, kRows, 1> y0 = lower.template triangularView<Eigen::Lower>().solve(e);
  const Eigen::Matrix<double, kRows, kStates> y =
      lower.template triangularView<Eigen::Lower>().solve(c.template leftCols<kStates>());
  const model::InputVector u0 = -range * y0;
  const Eigen::Matrix<double, kInputs, kStates> X = -range * y;

  const auto Hux = H.bottomLeftCorner<kInputs, kStates>();
  const auto Huu = H.bottomRightCorner<kInputs, kInputs>();
  const Eigen::Matrix<double, kInputs, kStates> by_state = Hux + Huu * X;
  const model::InputVector gu = g.tail<kInputs>() + Huu * u0;
  const auto step_u = step.rightCols<kInputs>();
  out.free = kFree;
  out.A.noalias() = step.leftCols<kStates>() + step_u * X;
  out.b.noalias() = defect + step_u * u0;
  out.Q = H.topLeftCorner<kStates, kStates>();
  out.Q.noalias() += X.transpose() * by_state + Hux.transpose() * X;
  out.Q *= h;
  out.q = g.head<kStates>() + Hux.transpose() * u0;
  out.q.noalias() += X.transpose() * gu;
  out.q *= h;
  out.B.leftCols<kFree>() = step_u * W;
  out.S.topRows<kFree>() = h * (W.transpose() * by_state);
  out.R.topLeftCorner<kFree, kFree>() = h * (W.transpose() * (Huu * W));
  out.r.head<kFree>() = h * (W.transpose() * gu);
}

}  // namespace

void baseline_linearise(const ocp::ProblemData& data, const ocp::StageBatch& batch, int lane,
                        const ocp::Trajectory& iterate, BaselineModel& out) {
  const int k = batch.stage[lane];
  BaselineStageData s{data, batch, lane, iterate.x[k], iterate.u[k], {}};
  data.robot->node_derivatives(s.x, s.u, data.joint_parameters, s.node);
  const double h = s.value(batch.duration);
  Dynamics step;
  model::StateVector reached;
  heun(*data.robot, s.x, s.u, h, step, reached);
  Hessian H = Hessian::Zero();
  Gradient g = Gradient::Zero();
  add_cost(s, H, g);
  const model::StateVector defect = reached - Eigen::Map<const model::StateVector>(iterate.x[k + 1]);
  switch (batch.mode.count()) {
    case 0:
      return project<6>(s, H, g, step, defect, h, out);
    case 1:
      return project<5>(s, H, g, step, defect, h, out);
    default:
      return project<4>(s, H, g, step, defect, h, out);
  }
}

}  // namespace stilt::benchmark
