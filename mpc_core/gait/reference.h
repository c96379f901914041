#pragma once

#include "mpc_core/gait/gait_library.h"
#include "mpc_core/gait/schedule.h"
#include "mpc_core/gait/swing.h"
#include "mpc_core/model/robot.h"

namespace stilt::gait {

/// Reference at one time, tracked by the running cost and by the swing constraint.
struct ReferencePoint {
  model::StateVector state = model::StateVector::Zero();
  model::InputVector input = model::InputVector::Zero();
  model::FeetVector foot_position_W_m = model::FeetVector::Zero();
  model::FeetVector foot_velocity_W_m_s = model::FeetVector::Zero();
  model::FeetVector foot_acceleration_W_m_s2 = model::FeetVector::Zero();
};

/// Joint angles [hip, knee], rad, that put a foot at (x, z) relative to the hip (m, torso upright), with a
/// positive knee angle. A point out of reach gives the straight leg towards it.
[[nodiscard]] Eigen::Vector2d leg_angles(double foot_x_m, double foot_z_m, double thigh_m,
                                         double shin_m) noexcept;

/// State that stands still with one foot `half_width_m` ahead of the hip and the other as far behind it.
[[nodiscard]] model::StateVector standing_state(const model::RobotConstants& robot, double base_height_m,
                                                double pitch_rad, double half_width_m,
                                                bool left_ahead) noexcept;

/// The heuristic reference of the paper. It has commanded height, pitch and speed, nominal joints, weight
/// shared among the stance feet, footholds below the hip at mid-contact. The speed reference and the
/// footholds yield to a measured speed far from the command. prepare() runs once per plan, evaluate() once
/// per node. Fixed memory, real-time safe.
class HeuristicReference {
 public:
  /// `state`: measured; anchors the reference in x. `speed_m_s`: speed reference at time_s.
  /// `foot_position_W_m`: measured [xL, zL, xR, zR]. `speed_trim_m_s`: added to the speed while stepping.
  void prepare(const model::RobotConstants& robot, const ContactSchedule& schedule,
               const GaitCommand& command, const GaitParameters& gait, const ReferenceParameters& parameters,
               double time_s, const model::StateVector& state, const model::FeetVector& foot_position_W_m,
               double speed_m_s, double speed_trim_m_s) noexcept;

  /// In single support the reference follows the library's gait for the speed reference, from the next call
  /// on; standing keeps the heuristics. The library must hold at least one gait and outlive this object.
  /// Null: heuristics always. See follow_gait().
  void follow(const model::RobotModel& model, const GaitLibrary* library) noexcept {
    model_ = &model;
    library_ = library;
  }

  /// Reference at a time in the contact phase `phase`, which selects the side of a switch.
  [[nodiscard]] ReferencePoint evaluate(double time_s, int phase) const noexcept;

  /// Speed reference without trim. `time_s`: not before the time given to prepare().
  [[nodiscard]] double speed_at(double time_s) const noexcept;

 private:
  static constexpr int kMaxKnots = ContactSchedule::kMaxPhases + 1;
  /// Speed that changes at a constant rate from a knot on until it reaches the knot's target.
  struct SpeedKnot {
    double time_s, x_m, speed_m_s, target_m_s, trim_m_s;
  };
  struct BaseMotion {
    double x_m, speed_m_s;  ///< the speed without trim
  };

  void prepare_speed(double time_s, double x_m, double speed_m_s, double trim_m_s) noexcept;
  [[nodiscard]] BaseMotion advance(const SpeedKnot& from, double time_s) const noexcept;
  [[nodiscard]] const SpeedKnot& knot_at(double time_s) const noexcept;
  [[nodiscard]] BaseMotion base_at(double time_s) const noexcept { return advance(knot_at(time_s), time_s); }
  /// Speed reference, moved towards the measured speed.
  [[nodiscard]] double followed_speed_m_s(double reference_m_s, double measured_m_s) const noexcept;
  /// Shift of a foothold by the measured speed's excess over the reference (Raibert's speed feedback).
  [[nodiscard]] double foothold_shift_m(const Interval& contact) const noexcept;
  [[nodiscard]] double foothold_x_m(int foot, const Interval& contact) const noexcept;
  void foot_reference(double time_s, int phase, int foot, Motion& x, Motion& z) const noexcept;

  /// Replaces the heuristics by the library's gait. Base, joints, their rates and accelerations, contact
  /// forces and swing foot are those of the gait at s = time since touch-down / phase duration. In x the base
  /// follows the speed reference, anchored at the measured base, plus the gait's lead within a step. Feet are
  /// placed relative to that; a foot in contact stays where it is.
  void follow_gait(double time_s, int phase, ReferencePoint& point) const noexcept;

  const ContactSchedule* schedule_ = nullptr;
  GaitCommand command_{};
  GaitParameters gait_{};
  ReferenceParameters parameters_{};
  double time_s_ = 0.0;
  double weight_N_ = 0.0;
  double speed_excess_m_s_ = 0.0;  ///< measured speed above the reference
  model::FeetVector measured_feet_ = model::FeetVector::Zero();
  model::StateVector nominal_ = model::StateVector::Zero();
  std::array<SpeedKnot, kMaxKnots> knots_{};
  int knot_count_ = 0;
  const model::RobotModel* model_ = nullptr;
  const GaitLibrary* library_ = nullptr;
};

}  // namespace stilt::gait
