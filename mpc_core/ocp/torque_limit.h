#pragma once

#include "mpc_core/ocp/barrier.h"

/// Torque limits that fall with the joint's speed in the direction of the torque (JointLimits). Real-time
/// safe.
namespace stilt::ocp {

/// Distances of a joint's torque from its two limits, Nm:
///   lower = limit + tau - slope max(-v, 0),   upper = limit - tau - slope max(v, 0).
struct TorqueMargins {
  Batch lower;
  Batch upper;

  TorqueMargins(const JointLimits& limits, int joint, const Batch& torque, const Batch& velocity) noexcept
      : lower(limits.torque_Nm[joint] + torque +
              limits.torque_speed_slope_Nms_rad[joint] * min(velocity, Batch(0.0))),
        upper(limits.torque_Nm[joint] - torque -
              limits.torque_speed_slope_Nms_rad[joint] * max(velocity, Batch(0.0))) {}
};

/// First and second derivatives of both barriers of a joint's torque, by torque and velocity. a and b are the
/// curvatures of the lower and the upper barrier, whose arguments move with tau + s_a v and tau + s_b v:
///
///   a (dtau + s_a dv)^2 + b (dtau + s_b dv)^2
///       = (a + b) (dtau + m dv)^2 + (a (s_a - m)^2 + b (s_b - m)^2) dv^2,   m = (a s_a + b s_b) / (a + b).
///
/// The result is one row over torque and velocity, and a diagonal term of the velocity. Gradients split in
/// the same way.
struct TorqueLimitCost {
  Batch by_velocity;      ///< m
  BarrierSlope combined;  ///< by tau + m v
  BarrierSlope velocity;  ///< by v alone, the remaining term

  TorqueLimitCost() = default;
  TorqueLimitCost(const BarrierCurve& p, const JointLimits& limits, int joint, const Batch& torque,
                  const Batch& v) noexcept {
    const TorqueMargins margins(limits, joint, torque, v);
    const BarrierPair barrier(p, margins.lower, margins.upper);
    combined = {barrier.a.first - barrier.b.first, barrier.a.second + barrier.b.second};
    const double slope = limits.torque_speed_slope_Nms_rad[joint];
    if (slope == 0.0) {
      by_velocity = velocity.first = velocity.second = Batch(0.0);
      return;
    }
    Batch lower_slope = Batch(slope);
    where(v >= 0.0, lower_slope) = Batch(0.0);
    const Batch upper_slope = slope - lower_slope;
    const Batch a = barrier.a.second;
    const Batch b = barrier.b.second;
    constexpr double kNoDivisionByZero = 1e-300;  // of barriers without weight
    by_velocity = (a * lower_slope + b * upper_slope) / (combined.second + kNoDivisionByZero);
    const Batch da = lower_slope - by_velocity;
    const Batch db = upper_slope - by_velocity;
    velocity = {barrier.a.first * da - barrier.b.first * db, a * da * da + b * db * db};
  }
};

}  // namespace stilt::ocp
