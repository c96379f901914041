#pragma once

#include "mpc_core/model/types.h"

namespace stilt::robot_on_bus {

/// State of the gantry.
enum class GantryState {
  holding,    ///< the robot hangs, its feet just above the ground
  lowering,   ///< its motors give torque: the rope pays out
  releasing,  ///< the robot carries itself: rope, guides and leg rests fade out
  off,        ///< the robot is free
  lifting,    ///< it fell or sat down: the rope lifts it clear of the ground, and the rests bend its legs
  settling,   ///< its legs are bent: it is let down to where it hangs, then its legs go into the pose
};

[[nodiscard]] const char* name(GantryState state);

/// Constants of the gantry and of its operation.
struct GantryParameters {
  double clearance_m = 0.005;           ///< of the feet above the ground while it hangs
  double rope_stiffness_N_m = 20000.0;  ///< upward only
  double rope_damping_Ns_m = 1500.0;
  double rope_strength = 4.0;           ///< largest force of the rope, in multiples of the robot's weight
  double guide_stiffness_N_m = 5000.0;  ///< of the guide along x
  double guide_damping_Ns_m = 600.0;
  double pitch_stiffness_Nm_rad = 2000.0;
  double pitch_damping_Nms_rad = 150.0;
  double rest_stiffness_Nm_rad = 200.0;  ///< rests that keep the legs in the starting pose
  double rest_damping_Nms_rad = 10.0;
  double rest_limit_Nm = 8.0;  ///< enough for a leg, too little for the body
  double torque_on_s = 0.2;    ///< the motors must give torque for this time before the rope pays out
  double lowering_speed_m_s = 0.02;
  double lowering_limit_m = 0.06;  ///< limit of the rope paid out
  double carried_share = 0.2;      ///< below this share of the weight on the rope the robot carries itself
  double carried_s = 0.3;          ///< for this time without interruption
  double release_s = 0.2;
  double lifting_speed_m_s = 0.2;
  double lifting_rate_rad_s = 0.8;
  double lifting_clearance_m = 0.15;  ///< above the height of hanging, more than a straight leg is longer
  double bent_knee_rad = 0.4;         ///< beyond the starting pose; the hips keep the feet below the robot
  double bent_margin_rad = 0.15;      ///< of every joint, at most, before the robot is let down
  double rest_rate_rad_s = 0.5;       ///< of the rests, into the pose
  bool keeps = false;                 ///< never pays out the rope
};

/// A robot that hangs high for good, its legs free: rests that damp and do not hold.
[[nodiscard]] GantryParameters hanging_for_good();

/// A stand for a robot with point feet while its motors are off. A rope holds the hip at the height of the
/// starting pose plus the clearance. Guides hold x and pitch. Leg rests hold the joints with at most
/// rest_limit_Nm, which is enough for hanging legs and too little for standing.
///
/// All forces are those of springs and dampers towards the starting pose, F = k (target - q) - d v; the rope
/// only pulls upward. When the motors give torque, the rope pays out slowly. Once it carries less than
/// carried_share of the weight for carried_s, all forces fade out within release_s. When the motors stop
/// giving torque before that, the rope is taken in again.
///
/// After a fall a leg may be straighter than in the pose. At the height of hanging such a leg jams between
/// hip and ground, and no rest moves it. So the rope lifts the robot clear of the ground first, as a person
/// does. It waits there until the legs are bent, whatever the motors do. Deterministic; the caller passes the
/// time.
class Gantry {
 public:
  /// @param standing  the starting pose, feet on the ground
  Gantry(const GantryParameters& parameters, const model::StateVector& standing, double weight_N);

  /// State of the robot hanging at rest: the starting pose, clearance_m higher.
  [[nodiscard]] model::StateVector hanging() const;

  /// Advances time. torque_on: every motor driver follows its commands, and the motors give torque.
  void elapse(const model::StateVector& state, bool torque_on, double duration_s);

  /// Force on the robot in this state, along the generalised coordinates: N, N, Nm on the base, Nm on the
  /// joints.
  [[nodiscard]] model::PositionVector force(const model::StateVector& state) const;

  /// Takes the weight of the robot again at its present position.
  void take(const model::StateVector& state);

  [[nodiscard]] GantryState state() const { return state_; }
  /// Number of releases so far.
  [[nodiscard]] int releases() const { return releases_; }

 private:
  [[nodiscard]] double rope_N(const model::StateVector& state) const;
  void pay_out(bool torque_on, double duration_s);
  void lift(const model::StateVector& state, double duration_s);
  void settle(double duration_s);

  GantryParameters parameters_;
  model::PositionVector target_;  ///< target of the springs; z: height of the robot hanging at rest
  model::PositionVector hanging_;
  model::PositionVector lifted_;  ///< clear of the ground, legs bent
  double weight_N_;
  GantryState state_ = GantryState::holding;
  double paid_out_m_ = 0.0;
  double strength_ = 1.0;  ///< 1 holding, 0 off
  double torque_on_s_ = 0.0;
  double carried_s_ = 0.0;
  int releases_ = 0;
};

}  // namespace stilt::robot_on_bus
