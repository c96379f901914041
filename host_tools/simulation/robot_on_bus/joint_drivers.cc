#include "host_tools/simulation/robot_on_bus/joint_drivers.h"

#include <algorithm>
#include <ranges>

namespace stilt::robot_on_bus {

JointDrivers::JointDrivers(const hal::RobotWiring& wiring, const JointMistakes& mistakes)
    : wiring_(wiring),
      mistakes_(mistakes),
      emulators_{hal::make_emulator(wiring.joints[0].driver), hal::make_emulator(wiring.joints[1].driver),
                 hal::make_emulator(wiring.joints[2].driver), hal::make_emulator(wiring.joints[3].driver)} {
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) driver(joint).lose_torque(mistakes[joint].dead);
  for (std::size_t bus = 0; bus < flexible_.size(); ++bus) flexible_[bus] = hal::FlexibleFrames(wiring_, bus);
}

hal::EmulatedDriver& JointDrivers::driver(std::size_t joint) {
  return std::visit([](auto& emulator) -> hal::EmulatedDriver& { return emulator; }, emulators_[joint]);
}

const hal::EmulatedDriver& JointDrivers::driver(std::size_t joint) const {
  return std::visit([](const auto& emulator) -> const hal::EmulatedDriver& { return emulator; },
                    emulators_[joint]);
}

void JointDrivers::set_motion(std::size_t joint, double position_rad, double velocity_rad_s) {
  if (mistakes_[joint].encoder_dead) return;
  const std::size_t reads = mistakes_[joint].encoder_exchanged ? joint ^ 1U : joint;
  const hal::JointWiring& wiring = wiring_.joints[reads];
  const double turns = (mistakes_[joint].encoder_reversed ? -1.0 : 1.0) * wiring.direction * wiring.ratio;
  hal::EmulatedDriver::Motor& motor = driver(reads).motor;
  motor.position_rad = turns * (position_rad - wiring.offset_rad);
  motor.velocity_rad_s = turns * velocity_rad_s;
}

void JointDrivers::set_pitch(double pitch_rad, double pitch_rate_rad_s) {
  if (wiring_.pitch_encoder_joint < 0) return;
  const auto joint = static_cast<std::size_t>(wiring_.pitch_encoder_joint);
  const double turns = wiring_.pitch_direction * wiring_.pitch_ratio;
  driver(joint).set_encoder(static_cast<std::size_t>(hal::extra_encoder_of(wiring_.joints[joint])),
                            turns * (pitch_rad - wiring_.pitch_offset_rad), turns * pitch_rate_rad_s);
}

double JointDrivers::torque_Nm(std::size_t joint) const {
  const hal::JointWiring& wiring = wiring_.joints[joint];
  const double turns = (mistakes_[joint].motor_reversed ? -1.0 : 1.0) * wiring.direction * wiring.ratio;
  return mistakes_[joint].torque_factor * wiring.torque_factor * turns * driver(joint).torque_Nm();
}

bool JointDrivers::all_enabled() const {
  return std::ranges::all_of(std::views::iota(std::size_t{0}, hal::kJoints),
                             [this](std::size_t joint) { return driver(joint).enabled(); });
}

}  // namespace stilt::robot_on_bus
