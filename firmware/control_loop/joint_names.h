#pragma once

#include <array>

#include "hal/robot/joint_bus.h"

namespace stilt::control_loop {

/// As in configuration, messages and files, in the order of hal::JointReadings.
inline constexpr std::array<const char*, hal::kJoints> kJointNames = {"hip_L", "knee_L", "hip_R", "knee_R"};

}  // namespace stilt::control_loop
