#pragma once

#include <limits>
#include <optional>

namespace stilt::hal::moteus {

/// Control position and velocity of an emulated moteus, in revolutions: what its gains hold to. Without
/// limits they are those of the command at once. With one, a trajectory of bounded acceleration and velocity
/// leads there from where the motor was. Facts: github.com/mjbots/moteus, fw/bldc_servo_position.h (db1a762).
/// Deterministic, fixed memory.
class MoteusTrajectory {
 public:
  static constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();

  struct Target {
    double position_rev = kUnset;  ///< unset: whatever the velocity leads to
    double velocity_rev_s = 0;
    double velocity_limit_rev_s = kUnset;  ///< unset: none
    double accel_limit_rev_s2 = kUnset;    ///< unset: none
  };
  struct Bounds {
    double minimum_rev = kUnset;  ///< unset: none
    double maximum_rev = kUnset;
  };

  /// Position mode ends: the next target starts from where the motor is then.
  void end() noexcept { started_ = false; }
  void aim(const Target& target) noexcept;
  /// duration_s passes, at this position and velocity of the motor.
  void advance(double duration_s, double position_rev, double velocity_rev_s, const Bounds& bounds) noexcept;

  [[nodiscard]] bool started() const noexcept { return started_; }
  [[nodiscard]] double position_rev() const noexcept { return position_rev_; }
  [[nodiscard]] double velocity_rev_s() const noexcept { return velocity_rev_s_; }

 private:
  [[nodiscard]] bool limited() const noexcept;
  void start(double position_rev, double velocity_rev_s) noexcept;
  void step(double step_s) noexcept;
  [[nodiscard]] double acceleration(double velocity_rev_s) const noexcept;
  void keep_within(const Bounds& bounds) noexcept;

  Target target_;
  bool reached_ = false;
  bool started_ = false;
  double position_rev_ = 0;
  double velocity_rev_s_ = 0;
};

}  // namespace stilt::hal::moteus
