#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "mpc_core/model/robot.h"

/// The numbers of a joint's drive from its motion. Pure; allocates, not for real time.
namespace stilt::commissioning {

/// What was asked and read, one entry per tick.
struct DriveRecord {
  std::vector<double> torque_Nm;  ///< asked of the joint, mean over the ticks beside the reading
  std::array<std::vector<double>, model::kAngles> angle_rad;  ///< pitch, hip_L, knee_L, hip_R, knee_R
};

/// A value and half of its 95 % confidence interval.
struct Estimate {
  double value = 0.0;
  double half_width = 0.0;
};

/// What the motions of a joint show of its drive.
struct DriveNumbers {
  Estimate torque_factor;  ///< given torque per asked torque
  Estimate armature_kg_m2;
  Estimate damping_Nms_rad;
  Estimate coulomb_friction_Nm;
  Estimate torque_offset_Nm;  ///< given while none is asked
  double residual_Nm = 0.0;   ///< root mean square
  std::size_t samples = 0;
};

/// Linear least squares on the joint's row of the inverse dynamics, link masses taken as exact:
///
///   tau_asked = (tau_rigid(q, v, a) + I a_j + d v_j + c sign(v_j) - tau_0) / k
///
/// for 1 / k, I / k, d / k, c / k and tau_0 / k: torque factor k, armature I, damping d, Coulomb friction c,
/// offset tau_0. The asked torque is on the left, since friction is never quite as modelled. As a regressor
/// it would draw k to 0 where friction exceeds gravity. The hip stands still: a gantry holds the robot. All
/// signals pass the same filter without phase, v and a are central differences. Times at which the joint is
/// slow, 60 ms around them, and the ends of a record are left out. The intervals come from the sums of
/// residuals over clusters of half a second, since neighbouring residuals are correlated (White 1980; Liang
/// and Zeger 1986). They cover noise, and no mistake of the model.
/// @param joint  that moved
/// @return  zero samples when nothing moved enough
[[nodiscard]] DriveNumbers fit_drive(const model::RobotModel& robot, std::size_t joint,
                                     std::span<const DriveRecord> records, double period_s);

}  // namespace stilt::commissioning
