#pragma once

#include "hal/ak/ak_protocol.h"
#include "hal/driver/emulated_driver.h"

namespace stilt::hal::ak {

/// What a driver keeps, by default as it may come from its vendor.
struct AkSettings {
  double status_rate_hz = 50;
  bool position_frames = false;
  bool single_turn = false;             ///< positions are 0 to 360 degrees
  std::int64_t command_timeout_ns = 0;  ///< without commands for so long its motor is off; 0: never
};

/// Set up as docs/deployment.md says.
[[nodiscard]] constexpr AkSettings documented_settings(const AkDriver& driver) noexcept {
  AkSettings settings;
  settings.status_rate_hz = driver.status_rate_hz;
  settings.position_frames = driver.position_frames;
  return settings;
}

/// What of its firmware is not public, or differs from one version to another, either way.
struct AkBehaviour {
  bool knows_disable = true;         ///< as manual 3.2.0; older firmware may not
  bool whole_scale = false;          ///< codes count by 2^n, not 2^n - 1
  bool position_first = false;       ///< of a report
  bool long_position_frame = false;  ///< 8 bytes
  bool sends_start = true;
  bool keeps_fault = false;         ///< until power is gone; otherwise it ends by itself
  bool keeps_turns = false;         ///< of its rotor, without power
  bool current_of_driving = false;  ///< its sign is that of driving (+) and braking (-), not of the torque
  std::int64_t fault_ns = 500'000'000;  ///< after which a fault ends
  double clock_error = 2e-4;            ///< its period is longer by this share
};

/// An AK of version 3. It is on from power-up and follows its newest command for ever. Every frame under the
/// identifier of commands is one, the special frames of version 2 too. A short one has zeros in the place of
/// missing bytes. It reports by its own clock.
class AkEmulator final : public EmulatedDriver {
 public:
  explicit AkEmulator(const AkDriver& driver, const AkSettings& settings = {},
                      const AkBehaviour& behaviour = {}) noexcept
      : driver_(driver), settings_(settings), behaviour_(behaviour) {}

  void take(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) noexcept override;
  void elapse(std::int64_t now_ns, FrameSink& replies) noexcept override;
  [[nodiscard]] double torque_Nm() const noexcept override;
  /// Its newest command is not limp, and no fault is in the way.
  [[nodiscard]] bool enabled() const noexcept override {
    return !limp(codes_) && !disabled_ && fault_code_ == 0;
  }
  [[nodiscard]] bool reports_supply() const noexcept override { return false; }
  void raise(DriverFault fault) noexcept override;
  void power_cycle() noexcept override;

 private:
  static constexpr AkCodes kLimp{0, 0, 0x7fff, 0x7ff, 0x7ff};

  void take_feedback(const CanFrame& frame) noexcept;
  void take_origin(const CanFrame& frame) noexcept;
  void report(FrameSink& replies) noexcept;
  [[nodiscard]] double reported_rad() const noexcept;
  [[nodiscard]] double current_A() const noexcept;

  AkDriver driver_;
  AkSettings settings_;
  AkBehaviour behaviour_;
  AkCodes codes_ = kLimp;
  std::uint8_t fault_code_ = 0;
  bool disabled_ = false;
  bool confirms_disable_ = false;
  bool starts_ = true;
  double kept_zero_rad_ = 0;         ///< in flash
  std::int64_t fault_since_ns_ = 0;  ///< 0: not seen yet
  std::int64_t commanded_ns_ = 0;
  std::int64_t next_report_ns_ = 0;
};

[[nodiscard]] inline AkEmulator make_emulator(const AkDriver& driver) noexcept {
  return AkEmulator(driver, documented_settings(driver));
}

}  // namespace stilt::hal::ak
