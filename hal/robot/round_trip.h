#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "hal/robot/clock.h"
#include "hal/robot/robot_wiring.h"
#include "hal/robot/tap_bus.h"

namespace stilt::hal {

/// The frame with which a driver replies to a command.
struct ReplyFrame {
  bool exists = false;  ///< ODrives do not reply
  std::uint8_t bus = 0;
  ReplyId reply;

  [[nodiscard]] bool is(const CanFrame& frame) const noexcept {
    return exists && frame.id == reply.id && frame.extended == reply.extended && !frame.error &&
           (frame.data[0] & reply.sender_mask) == reply.sender;
  }
};

/// Those of the joints.
[[nodiscard]] std::array<ReplyFrame, kJoints> reply_frames(const RobotWiring& wiring) noexcept;

/// Measures the time from commands to the last driver's reply, by reading the buses while the torque loop
/// has nothing else to do. ODrives do not reply to commands and are not waited for. Real-time safe.
class RoundTrip {
 public:
  /// @param taps  one per bus of the wiring, outlive this object
  RoundTrip(const RobotWiring& wiring, std::span<TapBus> taps) noexcept;

  /// Listens until every driver has replied, at most until give_up_ns. A reply to an earlier command that was
  /// not received yet would count: call it when the readings are complete.
  /// @return  nanoseconds since sent_ns; -1: not all replied in time, or none does ever
  [[nodiscard]] std::int64_t measure(Clock& clock, std::int64_t sent_ns, std::int64_t give_up_ns) noexcept;

  /// The newest time that was measured; 0: none yet.
  [[nodiscard]] std::int64_t newest_ns() const noexcept { return newest_ns_; }

 private:
  [[nodiscard]] bool all_replied() noexcept;

  std::span<TapBus> taps_;
  std::array<ReplyFrame, kJoints> replies_;
  std::int64_t newest_ns_ = 0;
};

}  // namespace stilt::hal
