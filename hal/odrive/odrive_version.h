#pragma once

#include <cstdint>

#include "hal/odrive/odrive_cansimple.h"

namespace stilt::hal::odrive {

/// 0xMMmmrr of major, minor and revision of the firmware. Real-time safe.
[[nodiscard]] constexpr std::uint32_t version_number(const OdriveVersion& version) noexcept {
  return static_cast<std::uint32_t>(version.firmware_major) << 16 |
         static_cast<std::uint32_t>(version.firmware_minor) << 8 | version.firmware_revision;
}

}  // namespace stilt::hal::odrive
