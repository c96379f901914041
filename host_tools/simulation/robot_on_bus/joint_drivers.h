#pragma once

#include <array>
#include <cstddef>

#include "hal/robot/emulated_joint.h"
#include "hal/robot/flexible_frames.h"
#include "hal/robot/robot_wiring.h"

namespace stilt::robot_on_bus {

/// What is wrong between a joint and its driver.
struct JointMistake {
  bool motor_reversed = false;     ///< its torque acts the other way
  double torque_factor = 1.0;      ///< given torque over the driver's: another torque constant
  bool encoder_reversed = false;   ///< it counts the other way
  bool dead = false;               ///< it gives no torque
  bool encoder_dead = false;       ///< it stays at its first angle
  bool encoder_exchanged = false;  ///< its encoder is wired to the driver of the leg's other joint
  bool blocked = false;            ///< something holds it where it first was
};
using JointMistakes = std::array<JointMistake, hal::kJoints>;

/// The four emulated motor drivers of a robot, with quantities at the joints. Direction, ratio and offset of
/// the wiring convert between a joint and its driver's shaft.
class JointDrivers {
 public:
  /// @param wiring  must be valid
  explicit JointDrivers(const hal::RobotWiring& wiring, const JointMistakes& mistakes = {});

  [[nodiscard]] hal::EmulatedDriver& driver(std::size_t joint);
  [[nodiscard]] const hal::EmulatedDriver& driver(std::size_t joint) const;
  [[nodiscard]] std::size_t bus(std::size_t joint) const { return wiring_.joints[joint].bus; }
  /// The frames of the drivers on a bus as they travel there.
  [[nodiscard]] const hal::FlexibleFrames& flexible(std::size_t bus) const { return flexible_[bus]; }

  /// Sets the reading of the joint's encoder, rad and rad/s at the joint.
  void set_motion(std::size_t joint, double position_rad, double velocity_rad_s);

  /// Sets the reading of an extra encoder at the torso, when the wiring has one.
  void set_pitch(double pitch_rad, double pitch_rate_rad_s);

  /// Torque of the motor at the joint, Nm, by the driver's law at the newest motion.
  [[nodiscard]] double torque_Nm(std::size_t joint) const;

  [[nodiscard]] bool all_enabled() const;

 private:
  hal::RobotWiring wiring_;
  std::array<hal::FlexibleFrames, hal::kMaximumBuses> flexible_;
  JointMistakes mistakes_;
  std::array<hal::JointEmulator, hal::kJoints> emulators_;
};

}  // namespace stilt::robot_on_bus
