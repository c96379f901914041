#pragma once

#include <atomic>
#include <cmath>
#include <cstddef>
#include <expected>
#include <limits>
#include <string>

#include "firmware/commissioning/dialog.h"
#include "firmware/configuration/hardware.h"
#include "hal/can/frame_bus.h"
#include "hal/robot/clock.h"

/// Makes the position in which a joint is held the zero of its driver, where the driver can. No motor is on.
/// Ordinary threads.
namespace stilt::commissioning {

/// At the driver's shaft, read back.
inline constexpr double kZeroTolerance_rad = 0.02;

/// Positions before and after a joint's driver was set to zero.
struct ZeroReport {
  std::size_t joint = 0;
  std::string protocol;
  int id = 0;
  double before_rad = std::numeric_limits<double>::quiet_NaN();  ///< at the driver's shaft
  double after_rad = std::numeric_limits<double>::quiet_NaN();
  std::string lasts;  ///< how long the driver keeps it, a sentence

  [[nodiscard]] bool good() const noexcept { return std::abs(after_rad) <= kZeroTolerance_rad; }
};

/// @param bus  of the joint. The error is bad input where the driver has no zero of its own; then nothing is
/// sent.
[[nodiscard]] std::expected<ZeroReport, CommandFailure> set_zero(
    const configuration::HardwareParameters& hardware, std::size_t joint, hal::FrameBus& bus,
    hal::Clock& clock, const std::atomic<bool>& stop);

[[nodiscard]] std::string to_text(const ZeroReport& report);
[[nodiscard]] std::string to_json(const ZeroReport& report);

}  // namespace stilt::commissioning
