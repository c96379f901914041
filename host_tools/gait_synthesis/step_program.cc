#include "host_tools/gait_synthesis/step_program.h"

#include <Eigen/QR>
#include <algorithm>

// Method, phase and step time of the gaits: docs/decisions/0008-gait-synthesis.md
namespace stilt::gait_synthesis {
namespace {

using Eigen::VectorXd;
using model::kFirstAngle;
using model::kFirstJoint;
using model::kJoints;
using model::kPositions;

constexpr double kFree = 1e20;
/// Index in q after the exchange of the legs: hip_L <- hip_R and so on.
constexpr int kSwapped[kPositions] = {0, 1, 2, 5, 6, 3, 4};
/// Margins of the program, so that the gait meets its limits between the nodes as well.
constexpr double kShare = 0.98;
constexpr double kClearanceRoom_m = 0.001;

/// Least height of the swing foot at t / step time = s: a plateau over the middle half, parabolas at both
/// ends.
double least_height(double s, double clearance_m) {
  const double from_end = 4.0 * std::min(s, 1.0 - s);
  return from_end >= 1.0 ? clearance_m + kClearanceRoom_m : clearance_m * from_end * from_end;
}

}  // namespace

StepProgram::StepProgram(const model::RobotModel& robot, const StepTask& task)
    : task_(task),
      constants_(robot.constants),
      joint_bounds_(joint_bounds(robot.constants, task.limits)),
      basis_(lobatto_basis(task.element_degree)),
      node_(robot, kShare * task.limits.friction_ratio, task.cost),
      impact_(robot, kShare * task.limits.impulse_ratio, kShare * task.limits.return_map,
              task.speed_m_s >= 0.0),
      nodes_(task.elements * task.element_degree + 1),
      element_s_(task.step_time_s / task.elements),
      by_hip_(task.phase == gait::PhaseKind::hip_position),
      time_(VectorXd::Zero(nodes_)),
      weight_(VectorXd::Zero(nodes_)) {
  for (int e = 0; e < task.elements; ++e) {
    for (int i = 0; i <= task.element_degree; ++i) {
      const int k = e * task.element_degree + i;
      time_[k] = (e + basis_.node[i]) / task.elements;
      weight_[k] += basis_.weight[i] / task.elements;
    }
  }
}

StepProgram::Phase StepProgram::phase(const VectorXd& v, int k) const {
  if (!by_hip_) return {time_[k], 1.0 / task_.step_time_s, 0.0};
  const double length = task_.step_length_m();
  const int at = node_at(k);
  return {(v[at] - v[node_at(0)]) / length, v[at + kVelocityAt] / length, v[at + kAccelerationAt] / length};
}

StepProgram::Bounds StepProgram::variable_bounds() const {
  Bounds bounds{VectorXd::Constant(variables(), -kFree), VectorXd::Constant(variables(), kFree)};
  const gait_files::GaitLimits& limits = task_.limits;
  for (int k = 0; k < nodes_; ++k) {
    const int at = node_at(k);
    bounds.lower[at + kFirstAngle] = -kShare * limits.pitch_rad;
    bounds.upper[at + kFirstAngle] = kShare * limits.pitch_rad;
    for (int j = 0; j < kJoints; ++j) {
      const double room = limits.joint_position_margin_rad / kShare;
      double& lower = bounds.lower[at + kFirstJoint + j];
      lower = joint_bounds_.position_min_rad[j] + room;
      if (j % 2 == 1) lower = std::max(lower, limits.knee_min_rad / kShare);
      bounds.upper[at + kFirstJoint + j] = joint_bounds_.position_max_rad[j] - room;
      bounds.lower[at + kVelocityAt + kFirstJoint + j] = -kShare * joint_bounds_.speed_rad_s[j];
      bounds.upper[at + kVelocityAt + kFirstJoint + j] = kShare * joint_bounds_.speed_rad_s[j];
    }
    bounds.lower[at + kForceAt + 1] = limits.normal_force_min_N / kShare;
  }
  return bounds;
}

void StepProgram::bound_node(int k, Bounds& bounds) const {
  const gait_files::GaitLimits& limits = task_.limits;
  const bool first = k == 0;
  const bool last = k == nodes_ - 1;
  const auto set = [&](int row, double lower, double upper) {
    bounds.lower[node_rows_at(k) + row] = lower;
    bounds.upper[node_rows_at(k) + row] = upper;
  };
  for (int r = 0; r < kNodeRows; ++r) set(r, -kFree, kFree);
  for (int r = 0; r < 3; ++r) set(kDynamicsRow + r, 0.0, 0.0);
  for (int r = 0; r < 2; ++r) set(kStanceAccelerationRow + r, 0.0, 0.0);
  for (int j = 0; j < kJoints; ++j) {
    const double torque_Nm = kShare * joint_bounds_.torque_Nm[j];
    set(kTorqueRow + j, -torque_Nm, torque_Nm);
  }
  for (int side = 0; side < 2; ++side) set(kConeRow + side, 0.0, kFree);
  if (first) {
    for (int r = 0; r < 2; ++r) set(kStanceRow + r, 0.0, 0.0);
    for (int r = 0; r < 2; ++r) set(kStanceVelocityRow + r, 0.0, 0.0);
    set(kSwingVelocityRow + 1, 0.0, kFree);
  } else if (last) {
    set(kSwingVelocityRow, -kShare * limits.touchdown_slip_m_s, kShare * limits.touchdown_slip_m_s);
    set(kSwingVelocityRow + 1, -kShare * limits.touchdown_speed_max_m_s,
        -limits.touchdown_speed_min_m_s / kShare);
  } else {
    set(kSwingRow + 1, least_height(time_[k], limits.clearance_m), kFree);
  }
}

StepProgram::Bounds StepProgram::constraint_bounds() const {
  Bounds bounds{VectorXd::Zero(rows()), VectorXd::Zero(rows())};
  for (int k = 0; k < nodes_; ++k) bound_node(k, bounds);
  bounds.lower[period_row()] = bounds.upper[period_row()] = task_.step_length_m();
  for (int r = impact_row() + kImpulseRow; r < rows(); ++r) bounds.upper[r] = kFree;
  if (!by_hip_) bounds.lower[impact_row() + kMomentumRow] = -kFree;
  return bounds;
}

double StepProgram::objective(const VectorXd& v) const {
  double sum = 0.0;
  for (int k = 0; k < nodes_; ++k) sum += weight_[k] * node_.cost(node(v, k));
  return sum;
}

VectorXd StepProgram::gradient(const VectorXd& v) const {
  VectorXd gradient = VectorXd::Zero(variables());
  for (int k = 0; k < nodes_; ++k) {
    gradient.segment<kNodeVariables>(node_at(k)) = weight_[k] * node_.cost_gradient(node(v, k));
  }
  return gradient;
}

void StepProgram::integrals(const VectorXd& v, VectorXd& g) const {
  const int p = task_.element_degree;
  for (int k = 1; k < nodes_; ++k) {
    const int from = (k - 1) / p * p;
    model::StateVector rest = node(v, k).head<model::kStates>() - node(v, from).head<model::kStates>();
    for (int l = 0; l <= p; ++l) {
      rest -= element_s_ * basis_.integration(k - from, l) *
              node(v, from + l).segment<model::kStates>(kVelocityAt);
    }
    g.segment<model::kStates>(integral_row(k)) = rest;
  }
}

void StepProgram::output_rows(const VectorXd& v, VectorXd& g) const {
  for (int k = 0; k < nodes_; ++k) {
    const Phase at = phase(v, k);
    for (int j = 0; j < kJoints; ++j) {
      const gait::BezierPoint y =
          gait::evaluate_bezier(v.data() + coefficient_at(j, 0), task_.output_degree, at.s);
      const double acceleration = v[node_at(k) + kAccelerationAt + kFirstJoint + j];
      g[output_row(k) + j] = acceleration - y.curvature * at.rate * at.rate - y.slope * at.acceleration;
      if (k > 0) continue;
      g[first_output_row() + j] = v[node_at(0) + kFirstJoint + j] - y.value;
      g[first_output_row() + kJoints + j] = v[node_at(0) + kVelocityAt + kFirstJoint + j] - y.slope * at.rate;
    }
  }
}

void StepProgram::period_rows(const VectorXd& v, VectorXd& g) const {
  const ImpactVector last = last_state(v);
  const NodeVector first = node(v, 0);
  for (int i = 0; i < kPositions; ++i) g[period_row() + i] = last[kSwapped[i]] - first[i];
  ImpactValues impact;
  ImpactSlopes unused;
  impact_.evaluate(last, impact, unused);
  for (int r = 0; r < model::kAngles; ++r) {
    impact[kRateRow + r] -= first[kVelocityAt + kSwapped[kFirstAngle + r]];
  }
  g.segment<kImpactRows>(impact_row()) = impact;
}

VectorXd StepProgram::constraints(const VectorXd& v) const {
  VectorXd g(rows());
  for (int k = 0; k < nodes_; ++k) {
    NodeValues values;
    NodeSlopes unused;
    node_.evaluate(node(v, k), values, unused);
    g.segment<kNodeRows>(node_rows_at(k)) = values;
  }
  integrals(v, g);
  output_rows(v, g);
  period_rows(v, g);
  return g;
}

void StepProgram::add_integrals(std::vector<Entry>& entries) const {
  const int p = task_.element_degree;
  for (int k = 1; k < nodes_; ++k) {
    const int from = (k - 1) / p * p;
    for (int i = 0; i < model::kStates; ++i) {
      const int row = integral_row(k) + i;
      entries.push_back({row, node_at(k) + i, 1.0});
      entries.push_back({row, node_at(from) + i, -1.0});
      for (int l = 0; l <= p; ++l) {
        entries.push_back(
            {row, node_at(from + l) + kVelocityAt + i, -element_s_ * basis_.integration(k - from, l)});
      }
    }
  }
}

void StepProgram::add_outputs(const VectorXd& v, int k, std::vector<Entry>& entries) const {
  const Phase at = phase(v, k);
  const int degree = task_.output_degree;
  const double rate2 = at.rate * at.rate;
  const Eigen::MatrixXd shape = bernstein_derivatives(at.s, degree, 3);
  for (int j = 0; j < kJoints; ++j) {
    const int row = output_row(k) + j;
    entries.push_back({row, node_at(k) + kAccelerationAt + kFirstJoint + j, 1.0});
    for (int i = 0; i <= degree; ++i) {
      entries.push_back({row, coefficient_at(j, i), -shape(2, i) * rate2 - shape(1, i) * at.acceleration});
    }
    if (!by_hip_) continue;
    const VectorXd y = shape * coefficients(v, j);
    const double length = task_.step_length_m();
    entries.push_back({row, node_at(k) + kVelocityAt, -2.0 * y[2] * at.rate / length});
    entries.push_back({row, node_at(k) + kAccelerationAt, -y[1] / length});
    if (k == 0) continue;  // the phase of the first node is 0
    const double by_x = -(y[3] * rate2 + y[2] * at.acceleration) / length;
    entries.push_back({row, node_at(k), by_x});
    entries.push_back({row, node_at(0), -by_x});
  }
}

void StepProgram::add_first_outputs(const VectorXd& v, std::vector<Entry>& entries) const {
  const int degree = task_.output_degree;
  const Phase at = phase(v, 0);
  for (int j = 0; j < kJoints; ++j) {
    const int position = first_output_row() + j;
    const int velocity = position + kJoints;
    entries.push_back({position, node_at(0) + kFirstJoint + j, 1.0});
    entries.push_back({position, coefficient_at(j, 0), -1.0});
    entries.push_back({velocity, node_at(0) + kVelocityAt + kFirstJoint + j, 1.0});
    entries.push_back({velocity, coefficient_at(j, 0), degree * at.rate});
    entries.push_back({velocity, coefficient_at(j, 1), -degree * at.rate});
    if (!by_hip_) continue;
    const double slope = degree * (v[coefficient_at(j, 1)] - v[coefficient_at(j, 0)]);
    entries.push_back({velocity, node_at(0) + kVelocityAt, -slope / task_.step_length_m()});
  }
}

void StepProgram::add_period(const VectorXd& v, std::vector<Entry>& entries) const {
  const int last = node_at(nodes_ - 1);
  for (int i = 0; i < kPositions; ++i) {
    entries.push_back({period_row() + i, last + kSwapped[i], 1.0});
    entries.push_back({period_row() + i, node_at(0) + i, -1.0});
  }
  for (int r = 0; r < model::kAngles; ++r) {
    entries.push_back(
        {impact_row() + kRateRow + r, node_at(0) + kVelocityAt + kSwapped[kFirstAngle + r], -1.0});
  }
  ImpactValues values;
  ImpactSlopes slopes;
  impact_.evaluate(last_state(v), values, slopes);
  for (int r = 0; r < kImpactRows; ++r) {
    for (int c = 0; c < kImpactVariables; ++c) {
      entries.push_back({impact_row() + r, last + c, slopes(r, c)});
    }
  }
}

std::vector<StepProgram::Entry> StepProgram::jacobian(const VectorXd& v) const {
  std::vector<Entry> entries;
  for (int k = 0; k < nodes_; ++k) {
    NodeValues values;
    NodeSlopes slopes;
    node_.evaluate(node(v, k), values, slopes);
    for (int r = 0; r < kNodeRows; ++r) {
      for (int c = 0; c < kNodeVariables; ++c) {
        entries.push_back({node_rows_at(k) + r, node_at(k) + c, slopes(r, c)});
      }
    }
    add_outputs(v, k, entries);
  }
  add_integrals(entries);
  add_first_outputs(v, entries);
  add_period(v, entries);
  return entries;
}

void StepProgram::add_output_hessian(const VectorXd& v, int k, const VectorXd& multipliers,
                                     std::vector<Entry>& entries) const {
  const Phase at = phase(v, k);
  const double length = task_.step_length_m();
  const double rate2 = at.rate * at.rate;
  const Eigen::MatrixXd shape = bernstein_derivatives(at.s, task_.output_degree, 4);
  const int x = node_at(k);
  const int first = node_at(0);
  for (int j = 0; j < kJoints; ++j) {
    const VectorXd y = shape * coefficients(v, j);
    const double once = -multipliers[output_row(k) + j] / length;  // one derivative by x or its rates
    const double twice = once / length;
    entries.push_back({x + kVelocityAt, x + kVelocityAt, twice * 2.0 * y[2]});
    for (int i = 0; i <= task_.output_degree; ++i) {
      entries.push_back({coefficient_at(j, i), x + kVelocityAt, once * 2.0 * shape(2, i) * at.rate});
      entries.push_back({coefficient_at(j, i), x + kAccelerationAt, once * shape(1, i)});
    }
    if (k == 0) continue;
    // The phase depends on x minus that of the first node.
    const auto both = [&](int row, double value) {
      entries.push_back({row, x, value});
      entries.push_back({row, first, -value});
    };
    const double second = twice * (y[4] * rate2 + y[3] * at.acceleration);
    both(x, second);
    entries.push_back({first, first, second});
    both(x + kVelocityAt, twice * 2.0 * y[3] * at.rate);
    both(x + kAccelerationAt, twice * y[2]);
    for (int i = 0; i <= task_.output_degree; ++i) {
      both(coefficient_at(j, i), once * (shape(3, i) * rate2 + shape(2, i) * at.acceleration));
    }
  }
}

void StepProgram::add_first_output_hessian(const VectorXd& multipliers, std::vector<Entry>& entries) const {
  for (int j = 0; j < kJoints; ++j) {
    const double value =
        multipliers[first_output_row() + kJoints + j] * task_.output_degree / task_.step_length_m();
    entries.push_back({coefficient_at(j, 0), node_at(0) + kVelocityAt, value});
    entries.push_back({coefficient_at(j, 1), node_at(0) + kVelocityAt, -value});
  }
}

std::vector<StepProgram::Entry> StepProgram::hessian(const VectorXd& v, double factor,
                                                     const VectorXd& multipliers) const {
  std::vector<Entry> entries;
  for (int k = 0; k < nodes_; ++k) {
    const NodeHessian block =
        node_.hessian(node(v, k), factor * weight_[k], multipliers.segment<kNodeRows>(node_rows_at(k)));
    for (int r = kFirstAngle; r < kNodeVariables; ++r) {
      for (int c = kFirstAngle; c <= r; ++c) {
        entries.push_back({node_at(k) + r, node_at(k) + c, block(r, c)});
      }
    }
    if (by_hip_) add_output_hessian(v, k, multipliers, entries);
  }
  if (by_hip_) add_first_output_hessian(multipliers, entries);
  const ImpactHessian block = impact_.hessian(last_state(v), multipliers.segment<kImpactRows>(impact_row()));
  const int at = node_at(nodes_ - 1);
  for (int r = kFirstAngle; r < kImpactVariables; ++r) {
    for (int c = kFirstAngle; c <= r; ++c) entries.push_back({at + r, at + c, block(r, c)});
  }
  return entries;
}

VectorXd StepProgram::pack(const Eigen::MatrixXd& q, const Eigen::MatrixXd& v,
                           const Eigen::MatrixXd& a) const {
  VectorXd packed = VectorXd::Zero(variables());
  for (int k = 0; k < nodes_; ++k) {
    packed.segment<kNodeVariables>(node_at(k)) << q.col(k), v.col(k), a.col(k), 0.0,
        constants_.total_mass_kg * model::kGravity_m_s2;
  }
  VectorXd s(nodes_);
  for (int k = 0; k < nodes_; ++k) s[k] = phase(packed, k).s;
  const auto fit = bernstein_matrix(s, task_.output_degree).colPivHouseholderQr();
  for (int j = 0; j < kJoints; ++j) {
    packed.segment(coefficient_at(j, 0), task_.output_degree + 1) =
        fit.solve(VectorXd(q.row(kFirstJoint + j).transpose()));
  }
  return packed;
}

gait::GaitOutputs StepProgram::outputs(const VectorXd& v) const {
  gait::GaitOutputs outputs;
  outputs.phase = task_.phase;
  outputs.phase_start = by_hip_ ? v[node_at(0)] : 0.0;
  outputs.phase_end = by_hip_ ? v[node_at(0)] + task_.step_length_m() : task_.step_time_s;
  outputs.degree = task_.output_degree;
  for (int j = 0; j < kJoints; ++j) {
    for (int i = 0; i <= task_.output_degree; ++i) outputs.angle_rad[j][i] = v[coefficient_at(j, i)];
  }
  return outputs;
}

}  // namespace stilt::gait_synthesis
