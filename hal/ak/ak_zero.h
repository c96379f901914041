#pragma once

#include <cmath>

#include "hal/ak/ak_protocol.h"
#include "hal/driver/zero_progress.h"

namespace stilt::hal::ak {

/// Limp commands first, since a command that is held would count from the new zero, too. Then the frame that
/// makes the present position zero, in flash; it is done when a status has that zero. Flash wears, so limp
/// commands take its place while a status is awaited. Start-up only.
class AkZero {
 public:
  explicit AkZero(const AkDriver& driver) noexcept : driver_(driver) {}

  /// Frame to send. `lost`: the one before had no answer.
  [[nodiscard]] CanFrame next(bool lost) noexcept {
    CanFrame frame;
    const bool writes = limp_ >= kLimp && (!lost || waited_ >= kPatience);
    waited_ = writes ? 0 : waited_ + 1;
    if (writes) return origin_frame(driver_, true);
    static_cast<void>(encode_limp(driver_, frame));  // of a valid driver it is one
    return frame;
  }

  [[nodiscard]] ZeroProgress take(const CanFrame& frame) noexcept {
    AkStatus status;
    if (decode_status(driver_, frame, status) != DecodeStatus::ok) return ZeroProgress::none;
    if (limp_ < kLimp) {
      ++limp_;
      return ZeroProgress::more;
    }
    return std::abs(status.position_rad) <= kZero_rad ? ZeroProgress::done : ZeroProgress::none;
  }

 private:
  static constexpr int kLimp = 3;       ///< commands
  static constexpr int kPatience = 20;  ///< frames until it is written again
  static constexpr double kZero_rad = 0.01;

  AkDriver driver_;
  int limp_ = 0;
  int waited_ = 0;
};

}  // namespace stilt::hal::ak
