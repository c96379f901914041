#pragma once

#include <cstddef>

#include "firmware/configuration/hardware.h"

namespace stilt::configuration {

/// The kind of driver of a joint: hips have one, knees another.
[[nodiscard]] const DriverParameters& driver_of(const HardwareParameters& hardware, std::size_t joint);

/// The section of the configuration with the keys of that kind.
[[nodiscard]] constexpr const char* driver_section(std::size_t joint) noexcept {
  return joint % 2 == 0 ? "hip_driver" : "knee_driver";
}

}  // namespace stilt::configuration
