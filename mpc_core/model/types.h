#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "codegen/generated/five_link/constants.h"

/// Sizes and vector types shared by all of mpc_core.
///
/// Coordinates: q = [x_b, z_b, pitch_b, hip_L, knee_L, hip_R, knee_R] (m, rad), v = dq/dt, state x = [q; v].
/// Input u = [joint accelerations (4), rad/s^2; contact forces fx_L, fz_L, fx_R, fz_R, N (world frame, on the
/// robot)]. World: x forward, z up. Angles are rotations about +y.
namespace stilt::model {

inline constexpr int kJoints = generated::five_link::kJointCount;
inline constexpr int kPositions = generated::five_link::kPositionCount;
inline constexpr int kStates = 2 * kPositions;
inline constexpr int kFeet = generated::five_link::kFootCount;
inline constexpr int kInputs = kJoints + 2 * kFeet;
/// theta = [pitch_b, hip_L, knee_L, hip_R, knee_R]: the dynamics depend on theta and its rates only.
inline constexpr int kAngles = 1 + kJoints;
/// Angles from the base to a foot: pitch, own hip, own knee.
inline constexpr int kChain = 3;
/// Indices into theta of the chain of each foot.
inline constexpr int kChainAngles[kFeet][kChain] = {{0, 1, 2}, {0, 3, 4}};
/// Index in q of the first angle; its rate is at kPositions + kFirstAngle in x.
inline constexpr int kFirstAngle = 2;
/// Index in q of the first joint.
inline constexpr int kFirstJoint = 3;

inline constexpr double kGravity_m_s2 = generated::five_link::kGravity_m_s2;

using StateVector = Eigen::Matrix<double, kStates, 1>;
using InputVector = Eigen::Matrix<double, kInputs, 1>;
using PositionVector = Eigen::Matrix<double, kPositions, 1>;
using JointVector = Eigen::Matrix<double, kJoints, 1>;
/// [xL, zL, xR, zR] in the world frame.
using FeetVector = Eigen::Matrix<double, 2 * kFeet, 1>;

/// Indices of the feet.
inline constexpr int kLeft = 0;
inline constexpr int kRight = 1;

/// Which feet carry load.
struct ContactMode {
  bool left = false;
  bool right = false;

  [[nodiscard]] constexpr bool operator[](int foot) const noexcept { return foot == kLeft ? left : right; }
  [[nodiscard]] constexpr int count() const noexcept { return int{left} + int{right}; }
  [[nodiscard]] constexpr bool operator==(const ContactMode&) const noexcept = default;
};

}  // namespace stilt::model
