#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "host_tools/simulation/plant/physics_model.h"
#include "host_tools/simulation/plant/plant_options.h"
#include "mpc_core/control/torque_law.h"
#include "mpc_core/model/types.h"

namespace stilt::simulation {

/// What the plant needs to know of a robot: its MJCF, and what is not in it.
struct PlantModel {
  std::string mjcf;
  model::JointVector torque_limit_Nm = model::JointVector::Zero();
  double nominal_hip_height_m = 0.8;
};

/// Where an external push acts, on the torso: at the hip, or kTorsoPushHeight_m above it.
enum class PushPoint { hip, torso };

/// The published height at which AMBER-3M's torso is pushed. It holds for every robot and every variant of
/// the torso's centre of mass, so that one push is one experiment whatever the masses.
inline constexpr double kTorsoPushHeight_m = 0.285;

/// Distance from the hip along the torso.
[[nodiscard]] constexpr double push_above_hip_m(PushPoint point) {
  return point == PushPoint::torso ? kTorsoPushHeight_m : 0.0;
}

/// Why the robot counts as fallen.
enum class Fall { none, hip_too_low, pitch_too_large, body_on_ground, not_finite };

/// "hip too low", ...
[[nodiscard]] const char* fall_text(Fall fall);

/// The robot and its world in MuJoCo: the plant under the controller. Repeats bit for bit from the same
/// model, options, seed and calls.
class Plant {
 public:
  /// `model` is make_plant_model() of the same options. Throws std::runtime_error when MuJoCo refuses it.
  Plant(const PlantModel& model, const PlantOptions& options, std::uint64_t seed);

  /// Places the robot; the delay line starts empty, the first torque commanded fills it, and drives with a
  /// lag start settled.
  void set_state(const model::StateVector& state);

  /// What the motors are asked for from now on. It acts delay_s later, saturated at the limit of that moment,
  /// and by the drives' lag: a drive limits its set point, so that its lag winds nothing up. What acts is
  /// saturated again, for the winding's voltage limits the torque at the present speed.
  void command_torque(const model::JointVector& torque_Nm);

  /// Horizontal force on the torso from now on, positive forward.
  void set_push(double force_N, PushPoint point);

  /// Force of the surroundings (a gantry, say) from now on, along the generalised coordinates: N, N, Nm on
  /// the base, Nm on the joints. Bears no delay and no limit.
  void set_surroundings_force(const model::PositionVector& force) { surroundings_force_ = force; }

  /// Advances by one time step.
  void step();

  /// What the sensors show now: noise of the plant's options, drawn anew on each call, then quantised.
  [[nodiscard]] control::SensorReading read_sensors();

  [[nodiscard]] model::StateVector state() const;
  [[nodiscard]] double time_step_s() const;
  /// Torque of the motors over the last time step.
  [[nodiscard]] const model::JointVector& applied_torque_Nm() const { return applied_torque_Nm_; }
  /// Age of the readings that the controller gets.
  [[nodiscard]] double reading_delay_s() const { return options_.reading_delay_s; }
  /// Largest torque of each motor at rest.
  [[nodiscard]] const model::JointVector& torque_limit_Nm() const { return torque_limit_Nm_; }
  /// Whether the set point of a drive stood at the motor's limit over the last time step: that of its speed,
  /// in its direction.
  [[nodiscard]] bool saturated() const { return saturated_; }
  /// Force of the ground on each foot over the last time step, world frame: fx_L, fz_L, fx_R, fz_R.
  [[nodiscard]] const model::FeetVector& contact_force_N() const { return contact_force_N_; }
  /// Lowest point of each shin, world frame: xL, zL, xR, zR.
  [[nodiscard]] const model::FeetVector& foot_position_m() const { return foot_position_m_; }
  /// Way of both feet along the ground while loaded (over 5 N at both ends of a time step), so far.
  [[nodiscard]] double slip_distance_m() const { return slip_distance_m_; }
  /// Kinetic and potential energy, the drives' share included.
  [[nodiscard]] double energy_J();
  /// Height of the ground below a point x of the world.
  [[nodiscard]] double ground_height_m(double x_m) const;
  /// Mass of all links.
  [[nodiscard]] double mass_kg() const;
  /// Position of the torso's centre of mass, world frame.
  [[nodiscard]] Eigen::Vector2d torso_com_m() const;

  /// Fallen: hip below 0.6 of its nominal height over the ground, pitch beyond 1 rad, a knee or the torso's
  /// centre of mass on the ground, or a state that is not finite.
  [[nodiscard]] Fall fall() const;

 private:
  [[nodiscard]] model::JointVector limit_Nm(const model::JointVector& torque_Nm) const;
  [[nodiscard]] model::JointVector limited(const model::JointVector& torque_Nm) const;
  [[nodiscard]] model::JointVector delayed_command_Nm();
  void drive();
  void apply_forces();
  void measure_contact();
  void measure_feet();

  PlantOptions options_;
  model::JointVector torque_limit_Nm_;
  double nominal_hip_height_m_;
  PhysicsIndices index_;
  ModelPointer model_;
  DataPointer data_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::vector<model::JointVector> delay_line_;  ///< one entry a time step of delay, oldest at delay_next_
  std::size_t delay_next_ = 0;
  bool delay_line_filled_ = false;
  double drive_share_ = 1.0;  ///< of its way to the set point that a drive's torque goes in a time step
  bool drives_settled_ = false;
  model::JointVector commanded_torque_Nm_ = model::JointVector::Zero();
  model::JointVector applied_torque_Nm_ = model::JointVector::Zero();
  bool saturated_ = false;
  model::FeetVector contact_force_N_ = model::FeetVector::Zero();
  model::FeetVector foot_position_m_ = model::FeetVector::Zero();
  double push_N_ = 0.0;
  PushPoint push_point_ = PushPoint::hip;
  model::PositionVector surroundings_force_ = model::PositionVector::Zero();
  double slip_distance_m_ = 0.0;
};

}  // namespace stilt::simulation
