#pragma once

#include <array>

#include "firmware/configuration/hardware.h"
#include "mpc_core/model/robot.h"

namespace stilt::configuration {

/// What the bring-up of each joint's driver requires of a robot.
/// @param angles_known  the joints are within their travel, by the one turn of their encoders that fits.
///                      False, before offsets are known: anywhere, by any turn
[[nodiscard]] std::array<hal::bring_up::Options, hal::kJoints> bring_up_options(
    const HardwareParameters& hardware, const model::RobotConstants& robot, bool angles_known);

}  // namespace stilt::configuration
