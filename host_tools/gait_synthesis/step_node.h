#pragma once

#include <Eigen/Core>

#include "mpc_core/model/robot.h"

/// The two nonlinear functions of the robot in the optimisation of a step with the left foot in stance at the
/// origin. One is for every node of the grid, one for the touch-down of the right foot. First derivatives are
/// exact (generated); second derivatives are central differences of them.
namespace stilt::gait_synthesis {

/// Variables of a node: q [7], v [7], dv/dt [7], force on the stance foot [2].
inline constexpr int kNodeVariables = 23;
inline constexpr int kVelocityAt = 7;
inline constexpr int kAccelerationAt = 14;
inline constexpr int kForceAt = 21;

/// Rows: three rows of the equations of motion (base acceleration of the dynamics minus the node's).
/// Acceleration, position and velocity of the stance foot; position and velocity of the swing foot (x z
/// each). Joint torques [4]; friction ratio * fz - fx and friction ratio * fz + fx.
inline constexpr int kNodeRows = 19;
inline constexpr int kDynamicsRow = 0;
inline constexpr int kStanceAccelerationRow = 3;
inline constexpr int kStanceRow = 5;
inline constexpr int kStanceVelocityRow = 7;
inline constexpr int kSwingRow = 9;
inline constexpr int kSwingVelocityRow = 11;
inline constexpr int kTorqueRow = 13;
inline constexpr int kConeRow = 17;

using NodeVector = Eigen::Matrix<double, kNodeVariables, 1>;
using NodeValues = Eigen::Matrix<double, kNodeRows, 1>;
using NodeSlopes = Eigen::Matrix<double, kNodeRows, kNodeVariables>;
using NodeHessian = Eigen::Matrix<double, kNodeVariables, kNodeVariables>;

/// Running cost of a node. The whole cost is its integral over the step.
enum class CostKind {
  torque_squared,    ///< 1e-3 (Nm)^-2 times the sum of squared joint torques
  mechanical_power,  ///< 1e-2 W^-1 times the sum of |torque * joint speed|, smoothed within 20 W, plus 3e-4
                     ///< (Nm)^-2 times the sum of squared joint torques
  acceleration_squared,  ///< 1e-3 s^4/rad^2 times the sum of squared joint accelerations
};

/// The function of one node: cost and rows, with their derivatives.
class StepNode {
 public:
  StepNode(const model::RobotModel& robot, double friction_ratio, CostKind cost)
      : robot_(robot), friction_ratio_(friction_ratio), cost_(cost) {}

  void evaluate(const NodeVector& z, NodeValues& rows, NodeSlopes& slopes) const;
  [[nodiscard]] double cost(const NodeVector& z) const;
  [[nodiscard]] NodeVector cost_gradient(const NodeVector& z) const;
  /// Hessian of factor * cost + multipliers' rows.
  [[nodiscard]] NodeHessian hessian(const NodeVector& z, double factor, const NodeValues& multipliers) const;

 private:
  [[nodiscard]] NodeVector lagrangian_gradient(const NodeVector& z, double factor,
                                               const NodeValues& multipliers) const;
  [[nodiscard]] NodeVector cost_gradient(const NodeVector& z, const NodeValues& rows,
                                         const NodeSlopes& slopes) const;
  [[nodiscard]] double cost(const NodeVector& z, const NodeValues& rows) const;

  const model::RobotModel& robot_;
  double friction_ratio_;
  CostKind cost_;
};

/// Variables of the touch-down: q [7], v [7] just before it. Rows: rates after it of pitch, hip_L, knee_L,
/// hip_R, knee_R. Then ratio * Jz - Jx, ratio * Jz + Jx and Jz of the impulse J. Last the margin of the
/// momentum, radius * |H-| - |H+|. H- is the angular momentum about the old stance foot before the impact, H+
/// that about the new one after it. Both are positive in the direction of travel. radius is the square root
/// of the largest eigenvalue allowed.
inline constexpr int kImpactVariables = 14;
inline constexpr int kImpactRows = 9;
inline constexpr int kRateRow = 0, kImpulseRow = 5, kMomentumRow = 8;

using ImpactVector = Eigen::Matrix<double, kImpactVariables, 1>;
using ImpactValues = Eigen::Matrix<double, kImpactRows, 1>;
using ImpactSlopes = Eigen::Matrix<double, kImpactRows, kImpactVariables>;
using ImpactHessian = Eigen::Matrix<double, kImpactVariables, kImpactVariables>;

/// The function of the touch-down: rows, with their derivatives.
class StepImpact {
 public:
  StepImpact(const model::RobotModel& robot, double impulse_ratio, double eigenvalue, bool forward)
      : robot_(robot),
        impulse_ratio_(impulse_ratio),
        radius_(std::sqrt(eigenvalue)),
        sign_(forward ? 1.0 : -1.0) {}

  void evaluate(const ImpactVector& y, ImpactValues& rows, ImpactSlopes& slopes) const;
  [[nodiscard]] ImpactHessian hessian(const ImpactVector& y, const ImpactValues& multipliers) const;

 private:
  [[nodiscard]] double momentum_row(const ImpactVector& y) const;

  const model::RobotModel& robot_;
  double impulse_ratio_;
  double radius_;
  double sign_;
};

}  // namespace stilt::gait_synthesis
