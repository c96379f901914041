#pragma once

#include <cstdint>

#include "hal/odrive/odrive_cansimple.h"

namespace stilt::hal::odrive {

/// 0xMMmmrr of major, minor and revision of the firmware. Real-time safe.
[[nodiscard]] constexpr std::uint32_t firmware_number(const OdriveVersion& version) noexcept {
  return static_cast<std::uint32_t>(version.firmware_major) << 16 |
         static_cast<std::uint32_t>(version.firmware_minor) << 8 | version.firmware_revision;
}

/// 0xLLvvaa of product line, version and variant of the hardware. Real-time safe.
[[nodiscard]] constexpr std::uint32_t hardware_number(const OdriveVersion& version) noexcept {
  return static_cast<std::uint32_t>(version.hardware_line) << 16 |
         static_cast<std::uint32_t>(version.hardware_version) << 8 | version.hardware_variant;
}

}  // namespace stilt::hal::odrive
