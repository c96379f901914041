#pragma once

#include "hal/driver/emulated_driver.h"
#include "hal/mit/damiao_registers.h"
#include "hal/mit/mit_mode.h"

namespace stilt::hal::mit {

/// A driver in MIT mode. With the Damiao layout it has registers and a timeout (off until written) after
/// which it disables itself and reports lost communication; with the others it has neither.
class MitEmulator final : public EmulatedDriver {
 public:
  explicit MitEmulator(const MitDriver& driver, std::uint32_t software_version = 5) noexcept
      : driver_(driver), software_version_(software_version) {}

  void take(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) noexcept override;
  void elapse(std::int64_t now_ns, FrameSink& replies) noexcept override;
  [[nodiscard]] double torque_Nm() const noexcept override;
  [[nodiscard]] bool enabled() const noexcept override { return enabled_; }
  [[nodiscard]] bool reports_supply() const noexcept override {
    return driver_.layout == ReplyLayout::mini_cheetah;
  }
  void raise(DriverFault fault) noexcept override;
  void power_cycle() noexcept override;

  /// Ranges the registers report, when they shall differ from what is configured.
  void report_torque_range(double maximum_Nm) noexcept { reported_torque_Nm_ = maximum_Nm; }

 private:
  void reply(FrameSink& replies) const noexcept;
  void take_special(MitSpecial special) noexcept;
  void take_register(DamiaoRegisterMessage message, FrameSink& replies) noexcept;
  [[nodiscard]] std::uint32_t register_bits(std::uint8_t number) const noexcept;

  MitDriver driver_;
  std::uint32_t software_version_;
  MitCommand command_;
  double reported_torque_Nm_ = 0;
  bool enabled_ = false;
  std::uint8_t fault_code_ = 0;
  std::uint32_t timeout_units_ = 0;
  std::int64_t last_command_ns_ = 0;
};

[[nodiscard]] inline MitEmulator make_emulator(const MitDriver& driver) noexcept {
  return MitEmulator(driver);
}

}  // namespace stilt::hal::mit
