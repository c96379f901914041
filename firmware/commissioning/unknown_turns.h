#pragma once

#include <string>

#include "hal/robot/robot_hardware.h"

namespace stilt::commissioning {

/// Names the joints that are up and whose angle may be wrong by whole turns of their driver's encoder. One
/// sentence for the user; empty: there are none.
[[nodiscard]] std::string unknown_turns(const hal::RobotHardware& hardware);

}  // namespace stilt::commissioning
