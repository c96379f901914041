#pragma once

#include <array>
#include <cstddef>

#include "hal/robot/emulated_joint.h"
#include "hal/robot/robot_wiring.h"

namespace stilt::robot_on_bus {

/// The four emulated motor drivers of a robot, seen from its joints: the wiring's direction, ratio and offset
/// lie between a joint and its driver's shaft.
class JointDrivers {
 public:
  /// @param wiring  valid
  explicit JointDrivers(const hal::RobotWiring& wiring);

  [[nodiscard]] hal::EmulatedDriver& driver(std::size_t joint);
  [[nodiscard]] const hal::EmulatedDriver& driver(std::size_t joint) const;
  [[nodiscard]] std::size_t bus(std::size_t joint) const { return wiring_.joints[joint].bus; }

  /// What the encoder of the joint reads from now on, rad and rad/s at the joint.
  void set_motion(std::size_t joint, double position_rad, double velocity_rad_s);

  /// What an extra encoder at the torso reads, when the wiring has one.
  void set_pitch(double pitch_rad, double pitch_rate_rad_s);

  /// Torque of the motor at the joint, Nm, from the driver's law at the newest motion.
  [[nodiscard]] double torque_Nm(std::size_t joint) const;

  [[nodiscard]] bool all_enabled() const;

 private:
  hal::RobotWiring wiring_;
  std::array<hal::JointEmulator, hal::kJoints> emulators_;
};

}  // namespace stilt::robot_on_bus
