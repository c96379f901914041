#pragma once

#include "firmware/supervisor/parameters.h"
#include "hal/robot/joint_bus.h"

/// The commands the supervisor gives instead of the torque law's. Pure, real-time.
namespace stilt::supervisor {

/// tau = -kd v, kp 0, torque 0. kd is lowered so that |kd v| stays within damping_torque_Nm. A joint whose
/// velocity is not finite is damped with the full kd by its driver.
[[nodiscard]] hal::JointCommands damped(const hal::JointReadings& measured, const JointLimits& limits,
                                        const SupervisorParameters& parameters) noexcept;

/// tau = s (kp (pose - q) - kd v), s from 0 to 1.
[[nodiscard]] hal::JointCommands held(const hal::JointValues& pose_rad, double s, const JointLimits& limits,
                                      const SupervisorParameters& parameters) noexcept;

/// Between two poses, at rest at both ends: q(s) = from + (to - from) s^2 (3 - 2 s), s clamped to 0 to 1.
[[nodiscard]] hal::JointValues pose_between_rad(const hal::JointValues& from_rad,
                                                const hal::JointValues& to_rad, double s) noexcept;

/// The torque law's commands while it is blended in. Share s of them counts, with the positions s of the way
/// from `start_rad`, and damping for the rest. tau = s tau_wanted - (1 - s) kd_damping v.
[[nodiscard]] hal::JointCommands blend_in(const hal::JointCommands& wanted, const hal::JointValues& start_rad,
                                          double s, const SupervisorParameters& parameters) noexcept;

/// No field of any joint is NaN or infinite.
[[nodiscard]] bool finite(const hal::JointCommands& commands) noexcept;

/// Torques and torque limits within the joints' limits; gains not negative. A driver without a
/// limit of its own gets lower ones where its law would be beyond the limit at this reading. The law is
/// tau = torque + kp (position - q) + kd (velocity - v). A driver that has no reading follows the law from
/// what it measures itself.
[[nodiscard]] hal::JointCommands bounded(const hal::JointCommands& commands,
                                         const hal::JointReadings& measured,
                                         const JointLimits& limits) noexcept;

/// The active torque limits: torque_limit_share of the joints'. Hot drivers and motors get less: from all of
/// that at hot_C to hot_torque_share of it at overheated_C. It is linear in a joint's hotter temperature.
/// Damping gets less, too: one limit holds at every level. With 0.3 of its torque, the least share, AMBER-3M
/// stands and sits down; with 0.25 it sinks.
[[nodiscard]] JointLimits derated(const JointLimits& limits, const hal::JointReadings& measured,
                                  const SupervisorParameters& parameters) noexcept;

/// The measured positions where they are finite, `before_rad` where not.
[[nodiscard]] hal::JointValues measured_pose_rad(const hal::JointReadings& measured,
                                                 const hal::JointValues& before_rad) noexcept;

}  // namespace stilt::supervisor
