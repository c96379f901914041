#pragma once

#include "codegen/generated/five_link/constants.h"
#include "mpc_core/model/terms.h"

namespace stilt::model {

/// Numbers of a five-link robot, indexed by generated::five_link::Number (SI units).
inline constexpr int kNumbers = generated::five_link::kNumberCount;
using generated::five_link::Number;

/// Constants of one robot: joints in the order hip_L, knee_L, hip_R, knee_R, both legs equal.
struct RobotConstants {
  const char* name;
  double numbers[kNumbers];  ///< masses, lengths, centres of mass, inertias
  double total_mass_kg;
  double thigh_length_m;
  double shin_length_m;
  double torso_com_height_m;  ///< centre of mass of the torso link above the hip, base frame
  double position_min_rad[kJoints];
  double position_max_rad[kJoints];
  double velocity_limit_rad_s[kJoints];
  double torque_limit_Nm[kJoints];
  double joint_parameters[2 * kJoints];  ///< armature (4) kg m^2, damping (4) Nm s/rad
};

/// Arguments of the generated functions besides state and input, computed once from a robot's numbers.
template <class T>
struct Coefficients {
  T coefficient[generated::five_link::kCoefficientCount];
};

/// A robot and its dynamics: plain data, and functions that are the same for all robots. T is double or
/// Batch (batch.h). Arguments: x[14], u[8], p[8] = {armature[4] (kg m^2), damping[4] (Nm s/rad)}; results:
/// terms.h. Real-time safe.
struct RobotModel {
  RobotConstants constants;
  Coefficients<double> coefficients;

  template <class T>
  void flow(const T* x, const T* u, FlowTerms<T>& out) const noexcept;
  template <class T>
  void flow_derivatives(const T* x, const T* u, FlowDerivatives<T>& out) const noexcept;
  template <class T>
  void node(const T* x, const T* u, const T* p, NodeTerms<T>& out) const noexcept;
  template <class T>
  void node_derivatives(const T* x, const T* u, const T* p, NodeDerivatives<T>& out) const noexcept;
  template <class T>
  void kinematics(const T* x, KinematicsTerms<T>& out) const noexcept;
  /// Rigid impact without slip or rebound that ends in `contact`: every foot of it comes to rest, also one
  /// that stood before. Without a foot nothing changes.
  template <class T>
  void impact(ContactMode contact, const T* x, const T* p, ImpactTerms<T>& out) const noexcept;
  template <class T>
  void impact_derivatives(ContactMode contact, const T* x, const T* p,
                          ImpactDerivatives<T>& out) const noexcept;
  template <class T>
  void mass_matrix(const T* x, const T* p, MassMatrixTerms<T>& out) const noexcept;
  template <class T>
  void bias(const T* x, BiasTerms<T>& out) const noexcept;
};

/// Makes the robot with these constants. Mass, lengths and height of the centre of mass follow from the
/// numbers.
[[nodiscard]] RobotModel make_robot(RobotConstants constants) noexcept;

}  // namespace stilt::model
