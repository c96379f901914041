#pragma once

#include <string>
#include <vector>

#include "hal/driver/scanned_driver.h"
#include "hal/mit/mit_mode.h"

/// The scan functions of hal/README.md for a driver in MIT mode. Start-up only.
namespace stilt::hal::mit {

/// A motor-off frame; before it, to a Damiao, a request for its version. Firmware that is silent while its
/// motor is off cannot be found so.
[[nodiscard]] std::vector<CanFrame> scan_frames(const MitDriver& driver);

/// Accepts any identifier of the reply: it names the driver in its data.
[[nodiscard]] bool take_scan(const MitDriver& driver, const CanFrame& frame, ScannedDriver& scanned);

/// Identifiers 1 to 15 of a Damiao, 1 to 32 of the others.
[[nodiscard]] std::vector<MitDriver> scan_others(const MitDriver& driver);

[[nodiscard]] constexpr bool sends_unasked(const MitDriver&) noexcept { return false; }
[[nodiscard]] constexpr int scan_id(const MitDriver& driver) noexcept { return driver.command_id; }
[[nodiscard]] std::string version_text(const MitDriver& driver, std::uint32_t version);

}  // namespace stilt::hal::mit
