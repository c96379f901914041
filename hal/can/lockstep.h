#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/can/bytes.h"
#include "hal/can/codec_status.h"
#include "hal/can/frame.h"

// clang-format off
/// Sync frames, for a controller and a simulated robot that take turns instead of following a clock. Each
/// side ends its turn with one sync frame on every bus: "tick k: all my frames of this tick are sent".
///
///   controller: commands, sync k on every bus          robot: takes them; with sync k from every bus
///   controller: waits for sync k from every bus   <-   advances one tick, sends what it has, sync k
///
/// Tick 0 opens the exchange: the robot answers it without advancing. Identifier extended, and of the lowest
/// priority there is; payload: k, 8 bytes, little endian. Such frames are on no real robot's bus. Real-time
/// safe, without state.
// clang-format on
namespace stilt::hal {

inline constexpr std::uint32_t kControllerSyncId = 0x1ffffff0;  ///< controller -> robot
inline constexpr std::uint32_t kRobotSyncId = 0x1ffffff1;       ///< robot -> controller
inline constexpr std::uint8_t kSyncBytes = 8;

/// The sync frame of a side (kControllerSyncId or kRobotSyncId) for a tick.
[[nodiscard]] constexpr CanFrame sync_frame(std::uint32_t id, std::uint64_t tick) noexcept {
  CanFrame frame = classic_frame(id, kSyncBytes);
  frame.extended = true;
  store_little(std::span(frame.data).first(kSyncBytes), tick);
  return frame;
}

/// The tick of a side's sync frame. not_addressed: another identifier or kind of frame. wrong_length: not 8
/// bytes.
[[nodiscard]] constexpr DecodeStatus decode_sync(std::uint32_t id, const CanFrame& frame,
                                                 std::uint64_t& tick) noexcept {
  if (frame.id != id || !frame.extended || frame.remote || frame.error || frame.fd) {
    return DecodeStatus::not_addressed;
  }
  if (frame.length != kSyncBytes) return DecodeStatus::wrong_length;
  tick = load_little(frame.payload());
  return DecodeStatus::ok;
}

}  // namespace stilt::hal
