#pragma once

#include <string>
#include <vector>

#include "hal/driver/scanned_driver.h"
#include "hal/moteus/moteus.h"

/// The scan functions of hal/README.md for a moteus. Start-up only.
namespace stilt::hal::moteus {

/// Two queries of registers: of its identity, of its state.
[[nodiscard]] std::vector<CanFrame> scan_frames(const MoteusDriver& driver);
[[nodiscard]] bool take_scan(const MoteusDriver& driver, const CanFrame& frame, ScannedDriver& scanned);
/// Every number from 1 to kMoteusMaximumId.
[[nodiscard]] std::vector<MoteusDriver> scan_others(const MoteusDriver& driver);
[[nodiscard]] constexpr bool sends_unasked(const MoteusDriver&) noexcept { return false; }
[[nodiscard]] constexpr int scan_id(const MoteusDriver& driver) noexcept { return driver.id; }
/// 0x010304 is 1.3.4.
[[nodiscard]] std::string version_text(const MoteusDriver& driver, std::uint32_t version);

}  // namespace stilt::hal::moteus
