#pragma once

#include <limits>

#include "hal/driver/emulated_driver.h"
#include "hal/odrive/odrive_cansimple.h"

namespace stilt::hal::odrive {

/// What an ODrive keeps in its own configuration, by default as it comes from the vendor. Also what of the
/// closed firmware 0.6 is not public, either way.
struct OdriveSettings {
  std::int64_t heartbeat_period_ns = 100'000'000;  ///< can.heartbeat_msg_rate_ms
  std::int64_t estimates_period_ns = 10'000'000;   ///< can.encoder_msg_rate_ms
  std::int64_t torques_period_ns = 0;              ///< can.torques_msg_rate_ms; 0: never
  double velocity_limit_rev_s = 2;                 ///< controller.config.vel_limit
  bool torque_mode_limit = true;                   ///< controller.config.enable_torque_mode_vel_limit
  bool answers_heartbeat_request = false;          ///< not public
  bool setpoints_alone_feed = false;               ///< the watchdog; not public
  bool expires_in_idle = true;                     ///< the watchdog, as in 0.5; not public
  std::int64_t enable_ns = 0;                      ///< from the request to closed loop; not public
  bool answers_version = true;                     ///< 0.5 does not
  double clock_error = 0;                          ///< its periods are longer by this share
};

/// Set up as docs/deployment.md says.
[[nodiscard]] constexpr OdriveSettings documented_settings() noexcept {
  OdriveSettings settings;
  settings.heartbeat_period_ns = 10'000'000;
  settings.estimates_period_ns = 1'000'000;
  settings.torques_period_ns = 5'000'000;
  settings.torque_mode_limit = false;
  settings.velocity_limit_rev_s = std::numeric_limits<double>::infinity();
  return settings;
}

inline constexpr OdriveVersion kEmulatedVersion{2, 4, 4, 58, 0, 6, 11, 0};

/// Of the firmware and the hardware that the endpoints are of.
[[nodiscard]] constexpr OdriveVersion version_of(const OdriveEndpoints& endpoints) noexcept {
  OdriveVersion version = kEmulatedVersion;
  const auto byte = [](std::uint32_t number, int shift) {
    return static_cast<std::uint8_t>(number >> shift & 0xff);
  };
  if (const std::uint32_t firmware = endpoints.firmware_version; firmware != 0) {
    version.firmware_major = byte(firmware, 16);
    version.firmware_minor = byte(firmware, 8);
    version.firmware_revision = byte(firmware, 0);
  }
  if (const std::uint32_t hardware = endpoints.hardware_version; hardware != 0) {
    version.hardware_line = byte(hardware, 16);
    version.hardware_version = byte(hardware, 8);
    version.hardware_variant = byte(hardware, 0);
  }
  return version;
}

/// ODrive with torque control: heartbeat, estimates and torques on timers, parameters for the watchdog. The
/// watchdog is off at first and disarms the axis when it expires. The ODrive holds its position until
/// another command comes. Facts: github.com/odriverobotics/ODrive,
/// Firmware/communication/can/can_simple.cpp, Firmware/MotorControl/controller.cpp (f9b5419, 0.5.6). Too
/// fast, it disarms in every mode.
class OdriveEmulator final : public EmulatedDriver {
 public:
  explicit OdriveEmulator(const OdriveDriver& driver, const OdriveSettings& settings = {},
                          const OdriveVersion& version = kEmulatedVersion) noexcept
      : node_(driver.node), endpoints_(driver.endpoints), settings_(settings), version_(version) {}

  void take(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) noexcept override;
  void elapse(std::int64_t now_ns, FrameSink& replies) noexcept override;
  [[nodiscard]] double torque_Nm() const noexcept override;
  [[nodiscard]] bool enabled() const noexcept override;
  [[nodiscard]] bool reports_supply() const noexcept override { return true; }
  void raise(DriverFault fault) noexcept override;
  void power_cycle() noexcept override;

 private:
  [[nodiscard]] bool due(std::int64_t now_ns, std::int64_t period_ns, std::int64_t& next_ns) const noexcept;
  void disarm(std::uint32_t error) noexcept;
  void take_state(std::int64_t now_ns, const CanFrame& frame) noexcept;
  void answer_request(OdriveCommand what, FrameSink& replies) const noexcept;
  void take_parameter(const OdriveParameter& request, FrameSink& replies) noexcept;
  void take_command(std::int64_t now_ns, OdriveCommand command, const CanFrame& frame,
                    FrameSink& replies) noexcept;

  static constexpr std::uint32_t kPositionControl = 3;  ///< controller.config.control_mode, as it comes

  std::uint8_t node_;
  OdriveEndpoints endpoints_;
  OdriveSettings settings_;
  OdriveVersion version_;
  std::uint32_t errors_ = 0;
  std::uint32_t state_ = static_cast<std::uint32_t>(OdriveState::idle);
  std::uint32_t control_mode_ = kPositionControl;
  double torque_Nm_ = 0;
  double held_rad_ = 0;  ///< where it was enabled
  float watchdog_s_ = 0;
  bool watchdog_enabled_ = false;
  std::int64_t fed_ns_ = 0;
  std::int64_t enabled_from_ns_ = 0;
  std::int64_t next_estimates_ns_ = 0;
  std::int64_t next_heartbeat_ns_ = 0;
  std::int64_t next_torques_ns_ = 0;
};

[[nodiscard]] inline OdriveEmulator make_emulator(const OdriveDriver& driver) noexcept {
  return OdriveEmulator(driver, documented_settings(), version_of(driver.endpoints));
}

}  // namespace stilt::hal::odrive
