#pragma once

#include <cmath>

#include "hal/driver/zero_progress.h"
#include "hal/mit/mit_mode.h"

namespace stilt::hal::mit {

/// The frame that makes the present position zero, after one that turns the motor off: a mini-cheetah takes
/// it only then. A Damiao and a mini-cheetah write it to flash; the AK's manual leaves that open.
/// Flash wears, so it is given once. Further frames only ask until the position is zero. Start-up only.
class MitZero {
 public:
  explicit MitZero(const MitDriver& driver) noexcept : driver_(driver) {}

  /// Frame to send. `lost`: the one before had no answer.
  [[nodiscard]] CanFrame next(bool /*lost*/) noexcept {
    const bool writes = off_ && !given_;
    given_ = given_ || writes;
    return special_frame(driver_, writes ? MitSpecial::set_zero : MitSpecial::leave);
  }

  [[nodiscard]] ZeroProgress take(const CanFrame& frame) noexcept {
    MitReply reply;
    if (decode_reply(driver_, frame, reply) != DecodeStatus::ok) return ZeroProgress::none;
    if (reply.reports_enabled && reply.enabled) return ZeroProgress::none;
    off_ = true;
    const bool over = given_ && (std::abs(reply.position_rad) <= kZero_rad || ++replies_ == kReplies);
    return over ? ZeroProgress::done : ZeroProgress::more;
  }

 private:
  static constexpr int kReplies = 20;  ///< after which it has not taken the zero
  static constexpr double kZero_rad = 0.01;

  MitDriver driver_;
  bool off_ = false;
  bool given_ = false;
  int replies_ = 0;
};

}  // namespace stilt::hal::mit
