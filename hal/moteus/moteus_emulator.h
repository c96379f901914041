#pragma once

#include <array>

#include "hal/driver/emulated_driver.h"
#include "hal/moteus/moteus.h"
#include "hal/moteus/moteus_trajectory.h"

namespace stilt::hal::moteus {

/// What a moteus keeps in its own configuration, by default as it comes from the maker with firmware 1.1.0.
struct MoteusSettings {
  std::uint32_t firmware_version = 0x010100;
  double kp_Nm_rev = 4;                                            ///< servo.pid_position.kp
  double ki = 0;                                                   ///< servo.pid_position.ki
  double kd_Nm_s_rev = 0.05;                                       ///< servo.pid_position.kd
  double default_accel_limit_rev_s2 = 50;                          ///< servo, of firmware 1.0.0 on
  double default_velocity_limit_rev_s = MoteusTrajectory::kUnset;  ///< servo
  MoteusTrajectory::Bounds bounds{.minimum_rev = -0.01, .maximum_rev = 0.01};  ///< servopos
  double timeout_max_torque_Nm = 5;                                            ///< servo
  std::int64_t enable_ns = 12'500'000;  ///< power stage 4 ms, zero of the current sensors 8.5 ms
};

/// Set up as docs/deployment.md says.
[[nodiscard]] constexpr MoteusSettings documented_settings(const MoteusDriver& driver) noexcept {
  MoteusSettings settings;
  settings.kp_Nm_rev = driver.kp_Nm_rev;
  settings.kd_Nm_s_rev = driver.kd_Nm_s_rev;
  settings.bounds = {};
  return settings;
}

/// moteus: registers, stopped to position mode over the time that its power stage takes, trajectory, bounds,
/// and the watchdog that latches mode `timeout` and damps until a stop arrives. A frame is answered before
/// what it writes takes effect. Facts: github.com/mjbots/moteus, fw/moteus_controller.cc,
/// fw/bldc_servo_control.h, fw/drv8323.cc (db1a762).
class MoteusEmulator final : public EmulatedDriver {
 public:
  explicit MoteusEmulator(const MoteusDriver& driver, const MoteusSettings& settings = {}) noexcept;

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
  static constexpr std::size_t kCommandRegisters = 10;
  using CommandRegisters = std::array<double, kCommandRegisters>;

  static double read(const void* context, std::uint32_t number) noexcept;
  static void write(void* context, std::uint32_t number, double value) noexcept;
  [[nodiscard]] double encoder_register(std::uint32_t offset) const noexcept;
  [[nodiscard]] double control_register(std::uint32_t number) const noexcept;
  [[nodiscard]] double position_error_rev() const noexcept;
  [[nodiscard]] double velocity_error_rev_s() const noexcept;
  [[nodiscard]] double damping_Nm() const noexcept;
  void apply(std::int64_t now_ns, MoteusMode wanted) noexcept;
  void aim() noexcept;
  void advance(std::int64_t now_ns) noexcept;
  void enter_position_mode() noexcept;

  MoteusDriver driver_;
  MoteusSettings settings_;
  MoteusMode mode_ = MoteusMode::stopped;
  MoteusHome home_ = MoteusHome::output;
  std::uint8_t fault_code_ = 0;
  CommandRegisters staged_{};   ///< registers 0x020 to 0x029 as the newest frame wrote them
  CommandRegisters command_{};  ///< in effect
  int staged_mode_ = -1;        ///< -1: the frame wrote none
  MoteusTrajectory trajectory_;
  double integral_Nm_ = 0;
  std::array<Encoder, kMoteusEncoders> encoders_{};
  bool ignore_watchdog_ = false;
  std::int64_t enabling_since_ns_ = 0;
  std::int64_t last_command_ns_ = 0;
  std::int64_t advanced_ns_ = 0;
};

[[nodiscard]] inline MoteusEmulator make_emulator(const MoteusDriver& driver) noexcept {
  return MoteusEmulator(driver, documented_settings(driver));
}

}  // namespace stilt::hal::moteus
