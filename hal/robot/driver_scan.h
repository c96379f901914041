#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/driver/scanned_driver.h"
#include "hal/robot/joint_driver.h"

/// The scan functions of hal/README.md for a driver of any family. Start-up only.
namespace stilt::hal {

[[nodiscard]] std::vector<CanFrame> scan_frames(const JointDriver& driver);
/// Whether the frame came from this driver; then it is part of `scanned`.
[[nodiscard]] bool take_scan(const JointDriver& driver, const CanFrame& frame, ScannedDriver& scanned);
[[nodiscard]] std::vector<JointDriver> scan_others(const JointDriver& driver);
[[nodiscard]] bool sends_unasked(const JointDriver& driver);
[[nodiscard]] int scan_id(const JointDriver& driver);
[[nodiscard]] std::string version_text(const JointDriver& driver, std::uint32_t version);

}  // namespace stilt::hal
