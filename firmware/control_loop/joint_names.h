#pragma once

#include <array>
#include <cstddef>

#include "hal/robot/joint_bus.h"

namespace stilt::control_loop {

/// As in configuration, messages and files, in the order of hal::JointReadings.
inline constexpr std::array<const char*, hal::kJoints> kJointNames = {"hip_L", "knee_L", "hip_R", "knee_R"};

/// The section of the configuration with the keys of the joint's kind of driver.
[[nodiscard]] constexpr const char* driver_section(std::size_t joint) noexcept {
  return joint % 2 == 0 ? "hip_driver" : "knee_driver";
}

}  // namespace stilt::control_loop
