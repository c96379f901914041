#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "hal/can/frame.h"
#include "hal/driver/driver_reading.h"

namespace stilt::hal {

/// What a driver has answered to questions that move nothing and enable nothing.
struct ScannedDriver {
  bool answered = false;
  std::optional<std::uint32_t> version;   ///< of its firmware, as bring_up::Options::minimum_version counts
  std::optional<std::uint32_t> reply_id;  ///< that it answers with, where this is a setting of the driver
  DriverReading reading;
  bool watchdog_ended = false;  ///< the last session: idle since, and no fault
};

/// 0x010304 is 1.3.4. Not real time.
[[nodiscard]] inline std::string dotted_bytes(std::uint32_t version) {
  return std::to_string(version >> 16 & 0xff) + '.' + std::to_string(version >> 8 & 0xff) + '.' +
         std::to_string(version & 0xff);
}

}  // namespace stilt::hal
