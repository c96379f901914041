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

/// Data of a robot for the plant: its MJCF, and values that MJCF does not contain.
struct PlantModel {
  std::string mjcf;
  model::JointVector torque_limit_Nm = model::JointVector::Zero();
  double nominal_hip_height_m = 0.8;
};

/// Point of the torso on which an external push acts: the hip, or kTorsoPushHeight_m above it.
enum class PushPoint { hip, torso };

/// The published height at which AMBER-3M's torso is pushed. It is the same for every robot and every centre
/// of mass, so that a push is the same experiment for all masses.
inline constexpr double kTorsoPushHeight_m = 0.285;

/// Distance of the point from the hip along the torso.
[[nodiscard]] constexpr double push_above_hip_m(PushPoint point) {
  return point == PushPoint::torso ? kTorsoPushHeight_m : 0.0;
}

/// Reason why the robot counts as fallen.
enum class Fall { none, hip_too_low, pitch_too_large, body_on_ground, not_finite };

/// Text of a reason: "hip too low", ...
[[nodiscard]] const char* fall_text(Fall fall);

/// The robot and its world in MuJoCo: the plant under the controller. The same model, options, seed and calls
/// give the same results, bit for bit.
class Plant {
 public:
  /// `model` must be made by make_plant_model() from the same options. Throws std::runtime_error when MuJoCo
  /// refuses it.
  Plant(const PlantModel& model, const PlantOptions& options, std::uint64_t seed);

  /// Sets the state of the robot. The delay line is then empty, and the first torque commanded fills it;
  /// drives with a lag start settled.
  void set_state(const model::StateVector& state);

  /// Sets the torque command of the motors. It becomes active delay_s later, limited to the torque limit at
  /// that moment, and after the drives' lag. The set point of a drive is limited, so that its lag does not
  /// wind up. The applied torque is limited again, because the winding's voltage limits the torque at the
  /// present speed.
  void command_torque(const model::JointVector& torque_Nm);

  /// Sets the horizontal force on the torso, positive forward.
  void set_push(double force_N, PushPoint point);

  /// Sets the force of the surroundings, such as a gantry, along the generalised coordinates: N, N, Nm on the
  /// base, Nm on the joints. It has no delay and no limit.
  void set_surroundings_force(const model::PositionVector& force) { surroundings_force_ = force; }

  /// Advances by one time step.
  void step();

  /// Reads the sensors: adds the noise of the plant's options, drawn anew at each call, then quantises.
  [[nodiscard]] control::SensorReading read_sensors();

  [[nodiscard]] model::StateVector state() const;
  [[nodiscard]] double time_step_s() const;
  /// Torque of the motors over the last time step.
  [[nodiscard]] const model::JointVector& applied_torque_Nm() const { return applied_torque_Nm_; }
  /// Age of the readings that the controller gets.
  [[nodiscard]] double reading_delay_s() const { return options_.reading_delay_s; }
  /// Largest torque of each motor at standstill.
  [[nodiscard]] const model::JointVector& torque_limit_Nm() const { return torque_limit_Nm_; }
  /// Whether the set point of a drive was at the motor's limit over the last time step, which depends on its
  /// speed and direction.
  [[nodiscard]] bool saturated() const { return saturated_; }
  /// Force of the ground on each foot over the last time step, world frame: fx_L, fz_L, fx_R, fz_R.
  [[nodiscard]] const model::FeetVector& contact_force_N() const { return contact_force_N_; }
  /// Lowest point of each shin, world frame: xL, zL, xR, zR.
  [[nodiscard]] const model::FeetVector& foot_position_m() const { return foot_position_m_; }
  /// Distance that both feet slid along the ground so far while loaded (over 5 N at both ends of a time
  /// step).
  [[nodiscard]] double slip_distance_m() const { return slip_distance_m_; }
  /// Kinetic and potential energy, including that of the drives.
  [[nodiscard]] double energy_J();
  /// Height of the ground at a point x of the world.
  [[nodiscard]] double ground_height_m(double x_m) const;
  /// Mass of all links.
  [[nodiscard]] double mass_kg() const;
  /// Position of the torso's centre of mass, world frame.
  [[nodiscard]] Eigen::Vector2d torso_com_m() const;

  /// Whether the robot has fallen: hip below 0.6 of its nominal height above the ground, pitch beyond 1
  /// rad. Also: a knee or the torso's centre of mass on the ground, or a non-finite state.
  [[nodiscard]] Fall fall() const;

  /// Share of the way to a fall that is left: the smaller of (hip - lowest hip) / (nominal hip - lowest hip)
  /// and 1 - |pitch| / largest pitch. Heights are above the ground, bounds as in fall(). At most 0 when the
  /// hip is too low or the pitch too large; knees and torso on the ground do not count.
  [[nodiscard]] double fall_margin() const;

 private:
  [[nodiscard]] model::JointVector limit_Nm(const model::JointVector& torque_Nm) const;
  [[nodiscard]] model::JointVector limited(const model::JointVector& torque_Nm) const;
  [[nodiscard]] model::JointVector delayed_command_Nm();
  void drive();
  void apply_forces();
  void measure_contact();
  void measure_feet();
  [[nodiscard]] double hip_above_ground_m() const;

  PlantOptions options_;
  model::JointVector torque_limit_Nm_;
  double nominal_hip_height_m_;
  PhysicsIndices index_;
  ModelPointer model_;
  DataPointer data_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::vector<model::JointVector> delay_line_;  ///< one entry per time step of delay, oldest at delay_next_
  std::size_t delay_next_ = 0;
  bool delay_line_filled_ = false;
  double drive_share_ = 1.0;  ///< share of the distance to its set point that a drive's torque covers per
                              ///< time step
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
