#pragma once

#include <cstdint>

#include "mpc_core/gait/bezier.h"
#include "mpc_core/model/types.h"

/// A periodic gait computed off line: joint angles as polynomials of a phase, and the motion that results.
///
/// Everything describes one step, which begins just after a touch-down. Coordinates of a gait: [x, z, pitch,
/// stance hip, stance knee, swing hip, swing knee]. x and z are those of the base (at the hip) from the
/// stance foot. With the left foot in stance they are the coordinates of model/types.h.
namespace stilt::gait {

/// Quantity that moves the phase of the outputs from s = 0 to s = 1.
enum class PhaseKind : std::uint8_t {
  time,          ///< s = (time since touch-down - start) / (end - start), in s
  hip_position,  ///< s = (x - start) / (end - start), x of the hip ahead of the stance foot, in m
};

inline constexpr int kMinOutputDegree = 4;
inline constexpr int kMaxOutputDegree = 7;
inline constexpr int kMaxMotionDegree = kMaxBezierDegree;

/// The virtual constraints: joint angles q_j = output_j(s) (rad), Bezier coefficients, joints in the order
/// stance hip, stance knee, swing hip, swing knee.
struct GaitOutputs {
  PhaseKind phase = PhaseKind::time;
  double phase_start = 0.0;  ///< in the unit of the phase: s or m
  double phase_end = 0.0;
  int degree = 0;  ///< kMinOutputDegree to kMaxOutputDegree
  double angle_rad[model::kJoints][kMaxOutputDegree + 1] = {};
};

/// Reduced state just after touch-down: pitch, stance hip, stance knee, swing hip, swing knee (rad) and their
/// rates (rad/s). The base follows from the stance foot.
inline constexpr int kReducedStates = 2 * model::kAngles;
using ReducedState = Eigen::Matrix<double, kReducedStates, 1>;

/// Tracking of the outputs: the output error e satisfies e'' + kd e' + kp e = 0. Foot placement moves the
/// swing hip's output at touch-down by -placement' (r - r0), blended in over the step. r is the measured
/// reduced state just after the last touch-down, r0 that of the gait.
struct OutputFeedback {
  double kp_1_s2 = 900.0;
  double kd_1_s = 60.0;
  double placement[kReducedStates] = {};  ///< rad/rad and rad/(rad/s)
};

/// The motion against t / step time, as Bezier coefficients: coordinates of a gait (m, rad). Joint torques
/// (Nm; stance hip, stance knee, swing hip, swing knee); force on the stance foot (N; x, z).
struct GaitMotion {
  int degree = 0;  ///< 0: no motion; at most kMaxMotionDegree
  double position[model::kPositions][kMaxMotionDegree + 1] = {};
  double torque_Nm[model::kJoints][kMaxMotionDegree + 1] = {};
  double force_N[2][kMaxMotionDegree + 1] = {};
};

/// A gait: its outputs, their feedback and the resulting motion.
struct HzdGait {
  double speed_m_s = 0.0;
  double step_time_s = 0.0;
  double step_length_m = 0.0;
  GaitOutputs outputs;
  OutputFeedback feedback;
  GaitMotion motion;
};

/// The motion of a gait at one time, in the coordinates of a gait, SI units.
struct GaitPoint {
  model::PositionVector position = model::PositionVector::Zero();
  model::PositionVector velocity = model::PositionVector::Zero();
  model::PositionVector acceleration = model::PositionVector::Zero();
  model::JointVector torque_Nm = model::JointVector::Zero();
  Eigen::Vector2d force_N = Eigen::Vector2d::Zero();
};

/// The motion at s = t / step time. Needs gait.motion. Real-time safe.
[[nodiscard]] GaitPoint motion_at(const HzdGait& gait, double s) noexcept;

/// The outputs at phase s with their derivatives by s (rad). Real-time safe.
struct OutputPoint {
  model::JointVector angle_rad = model::JointVector::Zero();
  model::JointVector slope_rad = model::JointVector::Zero();
  model::JointVector curvature_rad = model::JointVector::Zero();
};
[[nodiscard]] OutputPoint outputs_at(const GaitOutputs& outputs, double s) noexcept;

/// Share of a shifted foothold applied to the swing hip at phase s, with its derivatives:
///   10 s^3 - 15 s^4 + 6 s^5 within [0, 1], constant beyond.
/// It rises from 0 to 1 and is flat at both ends. Real-time safe.
[[nodiscard]] OutputPoint placement_share(double s) noexcept;

}  // namespace stilt::gait
