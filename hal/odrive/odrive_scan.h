#pragma once

#include <string>
#include <vector>

#include "hal/driver/scanned_driver.h"
#include "hal/odrive/odrive_cansimple.h"

/// The scan functions of hal/README.md for an ODrive. Start-up only.
namespace stilt::hal::odrive {

/// Remote frames that ask for version, estimates, temperatures and supply. Its heartbeat comes unasked.
[[nodiscard]] std::vector<CanFrame> scan_frames(const OdriveDriver& driver);
[[nodiscard]] bool take_scan(const OdriveDriver& driver, const CanFrame& frame, ScannedDriver& scanned);
/// Every node from 0 to 62.
[[nodiscard]] std::vector<OdriveDriver> scan_others(const OdriveDriver& driver);
[[nodiscard]] constexpr bool sends_unasked(const OdriveDriver&) noexcept { return true; }
[[nodiscard]] constexpr int scan_id(const OdriveDriver& driver) noexcept { return driver.node; }
/// 0x00060b is 0.6.11.
[[nodiscard]] std::string version_text(const OdriveDriver& driver, std::uint32_t version);

}  // namespace stilt::hal::odrive
