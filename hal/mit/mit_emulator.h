#pragma once

#include <numbers>

#include "hal/driver/emulated_driver.h"
#include "hal/mit/damiao_registers.h"
#include "hal/mit/mit_mode.h"

namespace stilt::hal::mit {

/// What a driver in MIT mode keeps: the registers of a Damiao DM-J4310, and the mode of an AK. The defaults
/// are those of its vendor. A mini-cheetah keeps nothing of this.
struct MitSettings {
  std::uint16_t reply_id = kDamiaoFactoryReplyId;  ///< MST_ID
  std::uint32_t control_mode = 1;                  ///< CTRL_MODE
  double position_range_rad = 12.5;                ///< PMAX
  double velocity_range_rad_s = 30;                ///< VMAX
  double torque_range_Nm = 10;                     ///< TMAX
  bool servo_mode = true;                          ///< AK: speaks another protocol
};

/// Set up as docs/deployment.md says.
[[nodiscard]] constexpr MitSettings documented_settings(const MitDriver& driver) noexcept {
  return {driver.reply_id,          1,    driver.position_rad.maximum, driver.velocity_rad_s.maximum,
          driver.torque_Nm.maximum, false};
}

/// What of the closed firmware of Damiao and AK is not public, either way.
struct MitBehaviour {
  bool answers_before_frame = false;  ///< Damiao: a frame is answered from the state before it
  bool timeout_while_off = false;     ///< Damiao: TIMEOUT runs from the write on, enabled or not
  bool silent_while_off = false;      ///< AK: answers only while it is on, and the frame that ends it
  bool keeps_fault = false;           ///< AK: until power is gone; otherwise until it is switched off
  std::int64_t enable_ns = 0;         ///< from the request to enabled
  /// Mini-cheetah: CAN_TIMEOUT, 1,000 loops of 25 us, after which it follows a command of zeros; 0: the
  /// firmware before 2021 has none.
  std::int64_t command_timeout_ns = 25'025'000;
  double rotor_turn_rad = 2 * std::numbers::pi / 9;  ///< of the shaft, as of an AK80-9; not of a Damiao
};

/// A driver in MIT mode. With the Damiao layout it has registers and a timeout (off until written) after
/// which it disables itself and reports lost communication. With the others it has neither. A mini-cheetah
/// answers every frame in every mode from the state before it, and keeps commands that it gets while it is
/// off. Source: github.com/bgkatz/motorcontrol, Core/Src/stm32f4xx_it.c, Core/Src/fsm.c (3586419); a trace of
/// that firmware: tests/data/traces.
class MitEmulator final : public EmulatedDriver {
 public:
  explicit MitEmulator(const MitDriver& driver, const MitSettings& settings = {},
                       std::uint32_t software_version = 5, const MitBehaviour& behaviour = {}) noexcept
      : driver_(as_set(driver, settings)),
        settings_(settings),
        software_version_(software_version),
        behaviour_(behaviour) {}

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
  /// The driver as it is, whatever a configuration has for it.
  static MitDriver as_set(MitDriver driver, const MitSettings& settings) noexcept;
  [[nodiscard]] bool in_servo_mode() const noexcept {
    return driver_.layout == ReplyLayout::ak && settings_.servo_mode;
  }
  void reply(FrameSink& replies) const noexcept;
  void send_servo_status(std::int64_t now_ns, FrameSink& replies) noexcept;
  void take_special(std::int64_t now_ns, MitSpecial special) noexcept;
  void take_register(DamiaoRegisterMessage message, FrameSink& replies) noexcept;
  [[nodiscard]] std::uint32_t register_bits(std::uint8_t number) const noexcept;

  MitDriver driver_;
  MitSettings settings_;
  std::uint32_t software_version_;
  MitBehaviour behaviour_;
  MitCommand command_;
  double reported_torque_Nm_ = 0;
  std::int64_t next_status_ns_ = 0;  ///< in servo mode
  bool enabled_ = false;
  std::uint8_t fault_code_ = 0;
  std::uint32_t timeout_units_ = 0;
  std::int64_t last_command_ns_ = 0;
  std::int64_t elapsed_ns_ = 0;       ///< time of the last elapse()
  std::int64_t uncommanded_ns_ = 0;   ///< time enabled since the last command
  std::int64_t enabled_from_ns_ = 0;  ///< 0: not asked to
};

[[nodiscard]] inline MitEmulator make_emulator(const MitDriver& driver) noexcept {
  return MitEmulator(driver, documented_settings(driver));
}

}  // namespace stilt::hal::mit
