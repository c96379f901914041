#pragma once

#include <array>
#include <cmath>

#include "mpc_core/control/parameters.h"
#include "mpc_core/model/robot.h"

namespace stilt::control {

/// Sensor readings of one tick: four joint encoders and the pitch of the base.
struct SensorReading {
  double time_s = 0.0;
  model::JointVector joint_position_rad = model::JointVector::Zero();
  model::JointVector joint_velocity_rad_s = model::JointVector::Zero();
  double base_pitch_rad = 0.0;
  double base_pitch_rate_rad_s = 0.0;
};

[[nodiscard]] inline bool is_finite(const SensorReading& reading) noexcept {
  return std::isfinite(reading.time_s) && reading.joint_position_rad.allFinite() &&
         reading.joint_velocity_rad_s.allFinite() && std::isfinite(reading.base_pitch_rad) &&
         std::isfinite(reading.base_pitch_rate_rad_s);
}

using BaseVelocity = Eigen::Vector2d;  ///< linear, x and z, m/s

/// Estimates the linear position and velocity of the base from the stance feet, in the world frame:
///
///   p_b = sum_f w_f (anchor_f - r_f(q)) / sum_f w_f,   v_b = - sum_f w_f dr_f/dt / sum_f w_f
///
/// r_f is the position of foot f relative to the base. anchor_f is its position on the ground, z = 0, at the
/// start of its scheduled contact. The weights w_f rise and fall linearly over `blend_s` at a scheduled
/// switch. A swing foot that was up and is now below the stance foot has landed early and carries. Height and
/// vertical velocity of the base follow it alone until the schedule changes. Where that is its scheduled
/// touch-down, its weight is then 1 at once. The horizontal velocity stays that of the scheduled foot, which
/// the plan is made for. The estimate drifts in x by the slip of the feet,
/// and does not drift in z. Real-time safe.
class Estimator {
 public:
  void configure(const model::RobotModel& robot, const EstimatorParameters& parameters) noexcept;

  /// Starts with both feet on the ground and the base at x = base_x_m (m, world).
  void reset(const SensorReading& reading, double base_x_m) noexcept;

  /// Processes one tick: takes the readings and the scheduled contacts, returns the state.
  /// @param planned_change  change of the base's velocity since the tick before, by the plan; null without a
  /// plan
  [[nodiscard]] model::StateVector update(const SensorReading& reading, model::ContactMode contact,
                                          const BaseVelocity* planned_change = nullptr) noexcept;

 private:
  /// v += planned change + (1 - exp(-dt / velocity_filter_s)) (measured - v)
  /// The correction is bounded. A foot that lands late moves at metres per second while the schedule has it
  /// on the ground. No push accelerates the base as fast. The pitch rate is the sensor's, without a filter:
  /// its lag would cost more than the sensor's noise.
  void filter_velocity(double elapsed_s, const BaseVelocity* planned_change,
                       model::StateVector& state) noexcept;

  /// Base position in x from the trusted feet, m; the last estimate when no foot is trusted.
  [[nodiscard]] double base_x_m(const model::KinematicsTerms<double>& feet) const noexcept;
  /// Weights of the feet in the height of the base.
  [[nodiscard]] std::array<double, model::kFeet> carrying(const model::KinematicsTerms<double>& feet,
                                                          model::ContactMode contact) noexcept;
  /// Anchors each foot whose contact begins, and updates the weights.
  void follow_contacts(const model::KinematicsTerms<double>& feet, double elapsed_s,
                       model::ContactMode contact) noexcept;

  const model::RobotModel* robot_ = nullptr;
  EstimatorParameters parameters_;
  double last_time_s_ = 0.0;
  double base_x_m_ = 0.0;
  BaseVelocity velocity_ = BaseVelocity::Zero();
  bool in_contact_[model::kFeet] = {};
  double weight_[model::kFeet] = {};
  double anchor_x_m_[model::kFeet] = {};
  model::ContactMode scheduled_{true, true};
  bool swing_foot_lifted_ = false;  ///< since the schedule changed
  bool landed_early_ = false;       ///< the swing foot, before the schedule changes
};

}  // namespace stilt::control
