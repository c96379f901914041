#pragma once

#include <array>
#include <optional>

#include "mpc_core/model/types.h"

namespace stilt::robot_on_bus {

/// A person's hands on a hanging robot. Each hand moves a joint, or the torso, to an angle and holds it
/// there:
///
///   F = k (a - q) - d v
///
/// where a goes to its target at kHandSpeed_rad_s, from where the hand took hold. Deterministic; the caller
/// passes the time.
class Hands {
 public:
  static constexpr double kHandSpeed_rad_s = 1.0;

  /// Takes hold of an angle, an index in q from model::kFirstAngle on, and moves it there.
  void move(int angle, double to_rad) { target_rad_[index(angle)] = to_rad; }
  /// Holds the left thigh still in the world, whatever the torso does.
  void hold_left_thigh() { holds_left_thigh_ = true; }
  /// Lets go of everything.
  void let_go() { *this = Hands(); }

  void elapse(const model::StateVector& state, double duration_s);

  /// Along the generalised coordinates, Nm.
  [[nodiscard]] model::PositionVector force(const model::StateVector& state) const;

 private:
  static constexpr int kAngles = model::kPositions - model::kFirstAngle;
  static std::size_t index(int angle) { return static_cast<std::size_t>(angle - model::kFirstAngle); }

  std::array<std::optional<double>, kAngles> target_rad_;
  std::array<std::optional<double>, kAngles> held_rad_;  ///< where the hand is
  bool holds_left_thigh_ = false;
  std::optional<double> thigh_rad_;  ///< angle of the left thigh in the world
};

}  // namespace stilt::robot_on_bus
