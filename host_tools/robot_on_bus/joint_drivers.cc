#include "host_tools/robot_on_bus/joint_drivers.h"

#include <algorithm>
#include <ranges>

namespace stilt::robot_on_bus {

JointDrivers::Emulator JointDrivers::emulator(const hal::JointWiring& wiring,
                                              const hal::bring_up::OdriveEndpoints& endpoints) {
  if (const auto* mit = std::get_if<hal::protocol::MitDriver>(&wiring.driver)) {
    return hal::mock::MitEmulator(*mit);
  }
  if (const auto* moteus = std::get_if<hal::protocol::MoteusDriver>(&wiring.driver)) {
    return hal::mock::MoteusEmulator(*moteus);
  }
  return hal::mock::OdriveEmulator(std::get<hal::OdriveNode>(wiring.driver).node, endpoints);
}

JointDrivers::JointDrivers(const hal::RobotWiring& wiring, const OdriveEndpoints& endpoints)
    : wiring_(wiring),
      emulators_{emulator(wiring.joints[0], endpoints[0]), emulator(wiring.joints[1], endpoints[1]),
                 emulator(wiring.joints[2], endpoints[2]), emulator(wiring.joints[3], endpoints[3])} {}

hal::mock::EmulatedDriver& JointDrivers::driver(std::size_t joint) {
  return std::visit([](auto& emulator) -> hal::mock::EmulatedDriver& { return emulator; }, emulators_[joint]);
}

const hal::mock::EmulatedDriver& JointDrivers::driver(std::size_t joint) const {
  return std::visit([](const auto& emulator) -> const hal::mock::EmulatedDriver& { return emulator; },
                    emulators_[joint]);
}

void JointDrivers::set_motion(std::size_t joint, double position_rad, double velocity_rad_s) {
  const hal::JointWiring& wiring = wiring_.joints[joint];
  const double turns = wiring.direction * wiring.ratio;
  hal::mock::EmulatedDriver::Motor& motor = driver(joint).motor;
  motor.position_rad = turns * (position_rad - wiring.offset_rad);
  motor.velocity_rad_s = turns * velocity_rad_s;
}

void JointDrivers::set_pitch(double pitch_rad, double pitch_rate_rad_s) {
  if (wiring_.pitch_encoder_joint < 0) return;
  const auto joint = static_cast<std::size_t>(wiring_.pitch_encoder_joint);
  const auto* moteus = std::get_if<hal::protocol::MoteusDriver>(&wiring_.joints[joint].driver);
  if (moteus == nullptr || moteus->extra_encoder < 0) return;
  std::get<hal::mock::MoteusEmulator>(emulators_[joint])
      .set_encoder(static_cast<std::size_t>(moteus->extra_encoder),
                   wiring_.pitch_direction * (pitch_rad - wiring_.pitch_offset_rad),
                   wiring_.pitch_direction * pitch_rate_rad_s);
}

double JointDrivers::torque_Nm(std::size_t joint) const {
  const hal::JointWiring& wiring = wiring_.joints[joint];
  return wiring.direction * wiring.ratio * driver(joint).torque_Nm();
}

bool JointDrivers::all_enabled() const {
  return std::ranges::all_of(std::views::iota(std::size_t{0}, hal::kJoints),
                             [this](std::size_t joint) { return driver(joint).enabled(); });
}

}  // namespace stilt::robot_on_bus
