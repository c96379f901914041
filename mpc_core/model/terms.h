#pragma once

#include "mpc_core/model/types.h"

/// Results of the generated functions, for one node (T = double) or a SIMD batch of nodes (T = Batch).
///
/// Suffixes: _dtheta, _domega columns are theta = [pitch, hip_L, knee_L, hip_R, knee_R] and its rates.
/// _dchain columns are the foot's own [pitch, hip, knee]; _du columns are the input; _dv the seven
/// velocities. Derivatives with respect to x_b, z_b and their rates are trivial (identity for foot position
/// and velocity, zero elsewhere) and not stored. Rows of the feet are [xL, zL, xR, zR], world frame, SI
/// units.
namespace stilt::model {

/// Mass matrix over q.
template <class T>
struct MassMatrixTerms {
  T mass_matrix[kPositions][kPositions];
};

/// Generalised forces of Coriolis, centrifugal and gravity terms, N and Nm.
template <class T>
struct BiasTerms {
  T bias[kPositions];
};

/// Positions and velocities of the feet, and their Jacobian d foot_position / d q.
template <class T>
struct KinematicsTerms {
  T foot_position[2 * kFeet];
  T foot_velocity[2 * kFeet];
  T foot_jacobian[2 * kFeet][kPositions];
};

/// Acceleration of the base [x, z, pitch] for given joint accelerations and contact forces.
template <class T>
struct FlowTerms {
  T base_acceleration[3];
};

/// FlowTerms with their derivatives.
template <class T>
struct FlowDerivatives {
  T base_acceleration[3];
  T base_acceleration_dtheta[3][kAngles];
  T base_acceleration_domega[3][kAngles];
  T base_acceleration_du[3][kInputs];
};

/// Base acceleration, feet and joint torques at one node.
template <class T>
struct NodeTerms {
  T base_acceleration[3];
  T foot_position[2 * kFeet];
  T foot_velocity[2 * kFeet];
  T foot_acceleration[2 * kFeet];
  T joint_torque[kJoints];
};

/// NodeTerms with their derivatives.
template <class T>
struct NodeDerivatives {
  T base_acceleration[3];
  T foot_position[2 * kFeet];
  T foot_velocity[2 * kFeet];
  T foot_acceleration[2 * kFeet];
  T joint_torque[kJoints];
  T base_acceleration_dtheta[3][kAngles];
  T base_acceleration_domega[3][kAngles];
  T base_acceleration_du[3][kInputs];
  T foot_position_dchain[2 * kFeet][kChain];  ///< also the derivative of foot_velocity by the chain's rates
  T foot_velocity_dchain[2 * kFeet][kChain];
  T foot_acceleration_dtheta[2 * kFeet][kAngles];
  T foot_acceleration_domega[2 * kFeet][kAngles];
  T foot_acceleration_du[2 * kFeet][kInputs];
  T joint_torque_dtheta[kJoints][kAngles];
  T joint_torque_domega[kJoints][kAngles];
  T joint_torque_du[kJoints][kInputs];
};

/// Velocities after an impact. Impulses of the feet on the robot, [x, z] of each, Ns; 0 at a foot without
/// contact.
template <class T>
struct ImpactTerms {
  T velocity_after[kPositions];
  T impulse[2 * kFeet];
};

/// ImpactTerms with their derivatives by the angles and the velocities before the impact.
template <class T>
struct ImpactDerivatives {
  T velocity_after[kPositions];
  T impulse[2 * kFeet];
  T velocity_after_dtheta[kPositions][kAngles];
  T velocity_after_dv[kPositions][kPositions];
  T impulse_dtheta[2 * kFeet][kAngles];
  T impulse_dv[2 * kFeet][kPositions];
};

}  // namespace stilt::model
