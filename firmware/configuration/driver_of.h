#pragma once

#include <cstddef>

#include "firmware/configuration/hardware.h"

namespace stilt::configuration {

/// The kind of driver of a joint: hips have one, knees another.
[[nodiscard]] const DriverParameters& driver_of(const HardwareParameters& hardware, std::size_t joint);

}  // namespace stilt::configuration
