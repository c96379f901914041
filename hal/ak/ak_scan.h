#pragma once

#include <string>
#include <vector>

#include "hal/ak/ak_protocol.h"
#include "hal/driver/scanned_driver.h"

/// The scan functions of hal/README.md for an AK of version 3. Start-up only.
namespace stilt::hal::ak {

/// None: it answers nothing, and what it sends by itself is all there is.
[[nodiscard]] inline std::vector<CanFrame> scan_frames(const AkDriver& /*driver*/) { return {}; }
[[nodiscard]] bool take_scan(const AkDriver& driver, const CanFrame& frame, ScannedDriver& scanned);
/// Every identifier from 0 to 255.
[[nodiscard]] std::vector<AkDriver> scan_others(const AkDriver& driver);
[[nodiscard]] constexpr bool sends_unasked(const AkDriver&) noexcept { return true; }
[[nodiscard]] constexpr int scan_id(const AkDriver& driver) noexcept { return driver.id; }
/// It reports none.
[[nodiscard]] inline std::string version_text(const AkDriver& /*driver*/, std::uint32_t /*version*/) {
  return "";
}

}  // namespace stilt::hal::ak
