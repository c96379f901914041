#pragma once

#include <cstdint>
#include <vector>

#include "hal/canopen/canopen.h"
#include "hal/canopen/encoder.h"
#include "hal/driver/emulated_driver.h"

namespace stilt::hal::canopen {

/// An absolute encoder on CANopen with its factory settings: pre-operational after power-up, no heartbeat,
/// and a first PDO that is not sent with SYNC. Deterministic. Sources as in encoder.h.
class EncoderEmulator {
 public:
  /// @param encoder  what it measures with
  explicit EncoderEmulator(const Encoder& encoder);

  /// Of its shaft, whole turns included.
  void set_motion(double angle_rad, double speed_rad_s) noexcept;

  /// A frame that was on the bus, for this node or not.
  void take(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies);
  /// Time passes: boot-up message and heartbeat.
  void elapse(std::int64_t now_ns, FrameSink& replies);
  /// As after a loss of power.
  void power_cycle();

  /// Changes an object of the dictionary, or adds it.
  void set_object(const Object& object, std::uint32_t value);
  /// Reads and writes of it are aborted.
  void remove_object(const Object& object);
  [[nodiscard]] NmtState state() const noexcept { return state_; }

 private:
  struct Entry {
    Object object;
    std::uint32_t value = 0;
    std::uint8_t bytes = 4;
  };
  [[nodiscard]] Entry* find(const Object& object) noexcept;
  [[nodiscard]] std::uint32_t value_of(const Object& object) noexcept;
  [[nodiscard]] SdoAnswer answer(const SdoRequest& request, std::uint8_t& bytes) noexcept;
  void change_state(NmtCommand command, FrameSink& replies);
  [[nodiscard]] CanFrame position_frame() noexcept;

  Encoder encoder_;
  std::vector<Entry> factory_;
  std::vector<Entry> objects_;
  NmtState state_ = NmtState::boot_up;
  std::uint32_t position_ = 0;
  std::int16_t speed_ = 0;
  std::int64_t next_heartbeat_ns_ = 0;
};

}  // namespace stilt::hal::canopen
