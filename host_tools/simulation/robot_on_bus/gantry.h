#pragma once

#include "mpc_core/model/types.h"

namespace stilt::robot_on_bus {

/// What the operator with the gantry does at the moment.
enum class GantryState {
  holding,    ///< the robot hangs, its feet just above the ground
  lowering,   ///< its motors give torque: the rope is paid out
  releasing,  ///< it carries itself: rope, guides and leg rests fade away
  off,        ///< the robot is on its own
  lifting,    ///< it fell or sat down: it is brought back to where it hangs
};

[[nodiscard]] const char* name(GantryState state);

/// Constants of the gantry and its operator.
struct GantryParameters {
  double clearance_m = 0.005;           ///< of the feet above the ground while it hangs
  double rope_stiffness_N_m = 20000.0;  ///< upward only
  double rope_damping_Ns_m = 1500.0;
  double rope_strength = 4.0;           ///< largest force of the rope, in weights of the robot
  double guide_stiffness_N_m = 5000.0;  ///< of the guide along x
  double guide_damping_Ns_m = 600.0;
  double pitch_stiffness_Nm_rad = 2000.0;
  double pitch_damping_Nms_rad = 150.0;
  double rest_stiffness_Nm_rad = 200.0;  ///< of the rests that keep the legs in the starting pose
  double rest_damping_Nms_rad = 10.0;
  double rest_limit_Nm = 8.0;  ///< enough for a leg, too little for the body
  double torque_on_s = 0.2;    ///< motors give torque for so long before the rope is paid out
  double lowering_speed_m_s = 0.02;
  double lowering_limit_m = 0.06;  ///< of rope paid out
  double carried_share = 0.2;      ///< below this share of the weight on the rope it carries itself
  double carried_s = 0.3;          ///< for so long without a break
  double release_s = 0.2;
  double lifting_speed_m_s = 0.2;
  double lifting_rate_rad_s = 0.8;
};

/// A stand that a robot with point feet needs while its motors are off. A rope holds the hip at the height of
/// the starting pose plus the clearance, guides hold x and pitch, and leg rests hold the joints with at most
/// rest_limit_Nm: enough that the legs do not dangle, too little to stand on.
///
/// All of it is springs and dampers towards the starting pose, F = k (target - q) - d v, the rope only
/// upward. When the motors give torque the rope is paid out slowly; once it carries less than carried_share
/// of the weight for carried_s, everything fades away within release_s. When the motors give up meanwhile the
/// rope is taken in again. Deterministic; time comes in.
class Gantry {
 public:
  /// @param standing  the starting pose, feet on the ground
  Gantry(const GantryParameters& parameters, const model::StateVector& standing, double weight_N);

  /// The robot as it hangs at rest: the starting pose, clearance_m higher.
  [[nodiscard]] model::StateVector hanging() const;

  /// Time passes. torque_on: every motor driver follows its commands, and the motors give torque.
  void elapse(const model::StateVector& state, bool torque_on, double duration_s);

  /// Force on the robot in this state, along the generalised coordinates: N, N, Nm; Nm on the joints.
  [[nodiscard]] model::PositionVector force(const model::StateVector& state) const;

  /// Takes the robot again where it is.
  void take(const model::StateVector& state);

  [[nodiscard]] GantryState state() const { return state_; }
  /// Number of releases.
  [[nodiscard]] int releases() const { return releases_; }

 private:
  [[nodiscard]] double rope_N(const model::StateVector& state) const;
  void pay_out(bool torque_on, double duration_s);
  void lift(double duration_s);

  GantryParameters parameters_;
  model::PositionVector target_;  ///< where springs pull to; z: where the robot hangs at rest
  model::PositionVector hanging_;
  double weight_N_;
  GantryState state_ = GantryState::holding;
  double paid_out_m_ = 0.0;
  double strength_ = 1.0;  ///< 1 holding, 0 off
  double torque_on_s_ = 0.0;
  double carried_s_ = 0.0;
  int releases_ = 0;
};

}  // namespace stilt::robot_on_bus
