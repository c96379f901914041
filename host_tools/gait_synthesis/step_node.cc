#include "host_tools/gait_synthesis/step_node.h"

#include <cmath>

namespace stilt::gait_synthesis {
namespace {

using model::kAngles;
using model::kChain;
using model::kFirstAngle;
using model::kInputs;
using model::kJoints;
using model::kPositions;
using model::kStates;

constexpr double kDifference = 1e-5;
constexpr double kTorqueScale = 1e-3;
constexpr double kPowerScale = 1e-2;
constexpr double kPowerRounding_W = 20.0;  // at 2 W the kinks cost Ipopt up to 500 iterations instead of 50
/// Squared torque in the cost of power. Power alone is flat along torques at rest and indefinite; Ipopt then
/// needs 33 to more than 500 iterations, depending on rounding. With squared torque it needs 33 to 87 over 15
/// speeds and step times.
constexpr double kPowerTorqueScale = 3e-4;
constexpr double kAccelerationScale = 1e-3;

/// Converts the node's variables to state and input: right foot free, left foot loaded.
void split(const NodeVector& z, double* x, double* u) {
  std::copy(z.data(), z.data() + kStates, x);
  std::copy(z.data() + kAccelerationAt + model::kFirstJoint, z.data() + kForceAt, u);
  u[kJoints] = z[kForceAt];
  u[kJoints + 1] = z[kForceAt + 1];
  u[kJoints + 2] = u[kJoints + 3] = 0.0;
}

/// Adds the derivatives of a row of foot_position or foot_velocity.
void add_foot(const model::NodeDerivatives<double>& n, int foot_row, int row, bool velocity,
              NodeSlopes& slopes) {
  const int foot = foot_row / 2;
  slopes(row, (velocity ? kVelocityAt : 0) + foot_row % 2) = 1.0;
  for (int c = 0; c < kChain; ++c) {
    const int at = kFirstAngle + model::kChainAngles[foot][c];
    slopes(row, at) = velocity ? n.foot_velocity_dchain[foot_row][c] : n.foot_position_dchain[foot_row][c];
    if (velocity) slopes(row, kVelocityAt + at) = n.foot_position_dchain[foot_row][c];
  }
}

template <class Angles, class Input>
void add_angles_and_inputs(const Angles& dtheta, const Angles& domega, const Input& du, int from, int row,
                           NodeSlopes& slopes) {
  for (int c = 0; c < kAngles; ++c) {
    slopes(row, kFirstAngle + c) = dtheta[from][c];
    slopes(row, kVelocityAt + kFirstAngle + c) = domega[from][c];
  }
  for (int c = 0; c < kJoints; ++c) slopes(row, kAccelerationAt + model::kFirstJoint + c) = du[from][c];
  for (int c = 0; c < 2; ++c) slopes(row, kForceAt + c) = du[from][kJoints + c];
}

}  // namespace

void StepNode::evaluate(const NodeVector& z, NodeValues& rows, NodeSlopes& slopes) const {
  double x[kStates];
  double u[kInputs];
  split(z, x, u);
  model::NodeDerivatives<double> n;
  robot_.node_derivatives(x, u, robot_.constants.joint_parameters, n);
  slopes.setZero();
  for (int r = 0; r < 3; ++r) {
    rows[kDynamicsRow + r] = n.base_acceleration[r] - z[kAccelerationAt + r];
    add_angles_and_inputs(n.base_acceleration_dtheta, n.base_acceleration_domega, n.base_acceleration_du, r,
                          kDynamicsRow + r, slopes);
    slopes(kDynamicsRow + r, kAccelerationAt + r) = -1.0;
  }
  for (int r = 0; r < 2; ++r) {
    rows[kStanceAccelerationRow + r] = n.foot_acceleration[r];
    rows[kStanceRow + r] = n.foot_position[r];
    rows[kStanceVelocityRow + r] = n.foot_velocity[r];
    rows[kSwingRow + r] = n.foot_position[2 + r];
    rows[kSwingVelocityRow + r] = n.foot_velocity[2 + r];
    add_angles_and_inputs(n.foot_acceleration_dtheta, n.foot_acceleration_domega, n.foot_acceleration_du, r,
                          kStanceAccelerationRow + r, slopes);
    add_foot(n, r, kStanceRow + r, false, slopes);
    add_foot(n, r, kStanceVelocityRow + r, true, slopes);
    add_foot(n, 2 + r, kSwingRow + r, false, slopes);
    add_foot(n, 2 + r, kSwingVelocityRow + r, true, slopes);
  }
  for (int j = 0; j < kJoints; ++j) {
    rows[kTorqueRow + j] = n.joint_torque[j];
    add_angles_and_inputs(n.joint_torque_dtheta, n.joint_torque_domega, n.joint_torque_du, j, kTorqueRow + j,
                          slopes);
  }
  for (int side = 0; side < 2; ++side) {
    const double sign = side == 0 ? -1.0 : 1.0;
    rows[kConeRow + side] = friction_ratio_ * z[kForceAt + 1] + sign * z[kForceAt];
    slopes(kConeRow + side, kForceAt) = sign;
    slopes(kConeRow + side, kForceAt + 1) = friction_ratio_;
  }
}

double StepNode::cost(const NodeVector& z, const NodeValues& rows) const {
  double sum = 0.0;
  for (int j = 0; j < kJoints; ++j) {
    const double torque = rows[kTorqueRow + j];
    const double acceleration = z[kAccelerationAt + model::kFirstJoint + j];
    const double power = torque * z[kVelocityAt + model::kFirstJoint + j];
    if (cost_ == CostKind::torque_squared) sum += kTorqueScale * torque * torque;
    if (cost_ == CostKind::acceleration_squared) sum += kAccelerationScale * acceleration * acceleration;
    if (cost_ == CostKind::mechanical_power)
      sum += kPowerScale * std::hypot(power, kPowerRounding_W) + kPowerTorqueScale * torque * torque;
  }
  return sum;
}

double StepNode::cost(const NodeVector& z) const {
  NodeValues rows;
  NodeSlopes slopes;
  evaluate(z, rows, slopes);
  return cost(z, rows);
}

NodeVector StepNode::cost_gradient(const NodeVector& z, const NodeValues& rows,
                                   const NodeSlopes& slopes) const {
  NodeVector gradient = NodeVector::Zero();
  for (int j = 0; j < kJoints; ++j) {
    const int speed_at = kVelocityAt + model::kFirstJoint + j;
    const int acceleration_at = kAccelerationAt + model::kFirstJoint + j;
    const double torque = rows[kTorqueRow + j];
    if (cost_ == CostKind::torque_squared)
      gradient += 2.0 * kTorqueScale * torque * slopes.row(kTorqueRow + j);
    if (cost_ == CostKind::acceleration_squared) {
      gradient[acceleration_at] += 2.0 * kAccelerationScale * z[acceleration_at];
    }
    if (cost_ == CostKind::mechanical_power) {
      const double power = torque * z[speed_at];
      const double factor = kPowerScale * power / std::hypot(power, kPowerRounding_W);
      gradient += (factor * z[speed_at] + 2.0 * kPowerTorqueScale * torque) * slopes.row(kTorqueRow + j);
      gradient[speed_at] += factor * torque;
    }
  }
  return gradient;
}

NodeVector StepNode::cost_gradient(const NodeVector& z) const {
  return lagrangian_gradient(z, 1.0, NodeValues::Zero());
}

NodeVector StepNode::lagrangian_gradient(const NodeVector& z, double factor,
                                         const NodeValues& multipliers) const {
  NodeValues rows;
  NodeSlopes slopes;
  evaluate(z, rows, slopes);
  return factor * cost_gradient(z, rows, slopes) + slopes.transpose() * multipliers;
}

NodeHessian StepNode::hessian(const NodeVector& z, double factor, const NodeValues& multipliers) const {
  NodeHessian hessian = NodeHessian::Zero();
  const auto along = [&](int c) {
    NodeVector ahead = z;
    NodeVector behind = z;
    const double move = kDifference * std::max(1.0, std::abs(z[c]));
    ahead[c] += move;
    behind[c] -= move;
    hessian.col(c) =
        (lagrangian_gradient(ahead, factor, multipliers) - lagrangian_gradient(behind, factor, multipliers)) /
        (2.0 * move);
  };
  // The dependence on position, velocity and acceleration of the base is linear.
  for (int c = kFirstAngle; c < kPositions; ++c) along(c);
  for (int c = kFirstAngle; c < kPositions; ++c) along(kVelocityAt + c);
  for (int c = model::kFirstJoint; c < kPositions; ++c) along(kAccelerationAt + c);
  for (int c = kForceAt; c < kNodeVariables; ++c) along(c);
  return 0.5 * (hessian + hessian.transpose());
}

double StepImpact::momentum_row(const ImpactVector& y) const {
  model::MassMatrixTerms<double> mass;
  model::KinematicsTerms<double> feet;
  model::ImpactTerms<double> impact;
  robot_.mass_matrix(y.data(), robot_.constants.joint_parameters, mass);
  robot_.kinematics(y.data(), feet);
  robot_.impact({.right = true}, y.data(), robot_.constants.joint_parameters, impact);
  // Momentum of the base coordinates: x, z and the rotation about +y at the hip.
  const auto momentum_about = [&](const double* velocity, int foot) {
    double p[3] = {0.0, 0.0, 0.0};
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < kPositions; ++c) p[r] += mass.mass_matrix[r][c] * velocity[c];
    }
    const double to_hip_x = y[0] - feet.foot_position[2 * foot];
    const double to_hip_z = y[1] - feet.foot_position[2 * foot + 1];
    return sign_ * (p[2] + to_hip_z * p[0] - to_hip_x * p[1]);
  };
  const double before = momentum_about(y.data() + kPositions, model::kLeft);
  const double after = momentum_about(impact.velocity_after, model::kRight);
  return radius_ * before - after;
}

void StepImpact::evaluate(const ImpactVector& y, ImpactValues& rows, ImpactSlopes& slopes) const {
  model::ImpactDerivatives<double> impact;
  robot_.impact_derivatives({.right = true}, y.data(), robot_.constants.joint_parameters, impact);
  slopes.setZero();
  for (int r = 0; r < kAngles; ++r) {
    rows[kRateRow + r] = impact.velocity_after[kFirstAngle + r];
    for (int c = 0; c < kAngles; ++c) {
      slopes(kRateRow + r, kFirstAngle + c) = impact.velocity_after_dtheta[kFirstAngle + r][c];
    }
    for (int c = 0; c < kPositions; ++c)
      slopes(kRateRow + r, kPositions + c) = impact.velocity_after_dv[kFirstAngle + r][c];
  }
  constexpr int kImpulseX = 2 * model::kRight;
  constexpr int kImpulseZ = kImpulseX + 1;
  const double mix[3][2] = {{-1.0, impulse_ratio_}, {1.0, impulse_ratio_}, {0.0, 1.0}};
  for (int r = 0; r < 3; ++r) {
    rows[kImpulseRow + r] = mix[r][0] * impact.impulse[kImpulseX] + mix[r][1] * impact.impulse[kImpulseZ];
    for (int c = 0; c < kAngles; ++c) {
      slopes(kImpulseRow + r, kFirstAngle + c) =
          mix[r][0] * impact.impulse_dtheta[kImpulseX][c] + mix[r][1] * impact.impulse_dtheta[kImpulseZ][c];
    }
    for (int c = 0; c < kPositions; ++c) {
      slopes(kImpulseRow + r, kPositions + c) =
          mix[r][0] * impact.impulse_dv[kImpulseX][c] + mix[r][1] * impact.impulse_dv[kImpulseZ][c];
    }
  }
  rows[kMomentumRow] = momentum_row(y);
  for (int c = 0; c < kImpactVariables; ++c) {
    ImpactVector ahead = y;
    ImpactVector behind = y;
    ahead[c] += kDifference;
    behind[c] -= kDifference;
    slopes(kMomentumRow, c) = (momentum_row(ahead) - momentum_row(behind)) / (2.0 * kDifference);
  }
}

ImpactHessian StepImpact::hessian(const ImpactVector& y, const ImpactValues& multipliers) const {
  ImpactHessian hessian = ImpactHessian::Zero();
  constexpr double kMove = 1e-4;  // the momentum row's slopes are differences too
  for (int c = kFirstAngle; c < kImpactVariables; ++c) {
    ImpactValues rows;
    ImpactSlopes slopes;
    ImpactVector at = y;
    at[c] = y[c] + kMove;
    evaluate(at, rows, slopes);
    hessian.col(c) = slopes.transpose() * multipliers;
    at[c] = y[c] - kMove;
    evaluate(at, rows, slopes);
    hessian.col(c) -= slopes.transpose() * multipliers;
    hessian.col(c) /= 2.0 * kMove;
  }
  return 0.5 * (hessian + hessian.transpose());
}

}  // namespace stilt::gait_synthesis
