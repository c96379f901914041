#pragma once

#include "mpc_core/model/batch.h"
#include "mpc_core/model/terms.h"

namespace stilt::model {

/// Constants of a robot, from its URDF. Joints in the order hip_L, knee_L, hip_R, knee_R.
struct RobotConstants {
  const char* name;
  double total_mass_kg;
  double thigh_length_m;
  double shin_length_m;
  double torso_com_height_m;  ///< of the torso link's centre of mass above the hip, base frame
  double position_min_rad[kJoints];
  double position_max_rad[kJoints];
  double velocity_limit_rad_s[kJoints];
  double torque_limit_Nm[kJoints];
  double joint_parameters[2 * kJoints];  ///< armature (4) kg m^2, damping (4) Nm s/rad
};

/// Generated dynamics of one robot, for one node and for a batch of nodes. Real-time safe.
/// Arguments: x[14], u[8], p[8] = {armature[4], damping[4]}; see terms.h for the results.
template <class T>
struct RobotFunctions {
  void (*flow)(const T* x, const T* u, FlowTerms<T>&) noexcept;
  void (*flow_derivatives)(const T* x, const T* u, FlowDerivatives<T>&) noexcept;
  void (*node)(const T* x, const T* u, const T* p, NodeTerms<T>&) noexcept;
  void (*node_derivatives)(const T* x, const T* u, const T* p, NodeDerivatives<T>&) noexcept;
  void (*kinematics)(const T* x, KinematicsTerms<T>&) noexcept;
  void (*impact[kFeet])(const T* x, const T* p, ImpactTerms<T>&) noexcept;
  void (*impact_derivatives[kFeet])(const T* x, const T* p, ImpactDerivatives<T>&) noexcept;
  void (*mass_matrix)(const T* x, const T* p, MassMatrixTerms<T>&) noexcept;
  void (*bias)(const T* x, BiasTerms<T>&) noexcept;
};

struct RobotModel {
  RobotConstants constants;
  RobotFunctions<double> scalar;
  RobotFunctions<Batch> batch;
};

[[nodiscard]] const RobotModel& amber3m() noexcept;
/// AMBER-3M with the other published centre of mass of the torso, 0.28507 m above the hip.
[[nodiscard]] const RobotModel& amber3m_2020() noexcept;
[[nodiscard]] const RobotModel& rabbit() noexcept;

/// The robot of that name, or nullptr.
[[nodiscard]] const RobotModel* find_robot(const char* name) noexcept;

}  // namespace stilt::model
