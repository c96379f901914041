#pragma once

#include <array>

#include "hal/driver/emulated_driver.h"
#include "hal/moteus/moteus.h"

namespace stilt::hal::moteus {

/// moteus: registers, position mode, and the watchdog that latches mode `timeout` and damps until a stop
/// arrives.
class MoteusEmulator final : public EmulatedDriver {
 public:
  explicit MoteusEmulator(const MoteusDriver& driver, std::uint32_t firmware_version = 0x010304) noexcept;

  void take(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) noexcept override;
  void elapse(std::int64_t now_ns, FrameSink& replies) noexcept override;
  [[nodiscard]] double torque_Nm() const noexcept override;
  [[nodiscard]] bool enabled() const noexcept override { return mode() == MoteusMode::position; }
  [[nodiscard]] bool reports_supply() const noexcept override { return true; }
  void raise(DriverFault fault) noexcept override;
  void power_cycle() noexcept override;

  [[nodiscard]] MoteusMode mode() const noexcept { return mode_; }
  void set_home(MoteusHome home) noexcept { home_ = home; }
  void set_encoder(std::size_t encoder, double position_rad, double velocity_rad_s) noexcept override {
    encoders_[encoder] = {position_rad, velocity_rad_s};
  }
  /// A firmware that does not keep the watchdog written to it.
  void ignore_watchdog(bool ignore) noexcept { ignore_watchdog_ = ignore; }

 private:
  struct Encoder {
    double position_rad = 0;
    double velocity_rad_s = 0;
  };
  static double read(const void* context, std::uint32_t number) noexcept;
  static void write(void* context, std::uint32_t number, double value) noexcept;
  [[nodiscard]] double encoder_register(std::uint32_t offset) const noexcept;

  MoteusDriver driver_;
  std::uint32_t firmware_version_;
  MoteusMode mode_ = MoteusMode::stopped;
  MoteusHome home_ = MoteusHome::output;
  std::uint8_t fault_code_ = 0;
  std::array<double, 8> command_{};  ///< registers 0x020 to 0x027
  std::array<Encoder, kMoteusEncoders> encoders_{};
  bool ignore_watchdog_ = false;
  std::int64_t last_command_ns_ = 0;
};

[[nodiscard]] inline MoteusEmulator make_emulator(const MoteusDriver& driver) noexcept {
  return MoteusEmulator(driver);
}

}  // namespace stilt::hal::moteus
