#pragma once

#include "hal/driver/zero_progress.h"
#include "hal/mit/mit_mode.h"

namespace stilt::hal::mit {

/// The frame that makes the present position zero, after one that turns the motor off: a mini-cheetah takes
/// it only then. A Damiao and a mini-cheetah write it to flash; the AK's manual leaves that open. Start-up
/// only.
class MitZero {
 public:
  explicit MitZero(const MitDriver& driver) noexcept : driver_(driver) {}

  /// Frame to send. `lost`: the one before had no answer.
  [[nodiscard]] CanFrame next(bool /*lost*/) const noexcept {
    return special_frame(driver_, off_ ? MitSpecial::set_zero : MitSpecial::leave);
  }

  [[nodiscard]] ZeroProgress take(const CanFrame& frame) noexcept {
    MitReply reply;
    if (decode_reply(driver_, frame, reply) != DecodeStatus::ok) return ZeroProgress::none;
    if (reply.says_enabled && reply.enabled) return ZeroProgress::none;
    if (off_) return ZeroProgress::done;
    off_ = true;
    return ZeroProgress::more;
  }

 private:
  MitDriver driver_;
  bool off_ = false;
};

}  // namespace stilt::hal::mit
