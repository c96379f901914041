#pragma once

#include <array>
#include <optional>

#include "hal/driver/emulated_driver.h"
#include "hal/moteus/moteus.h"
#include "hal/moteus/moteus_console.h"
#include "hal/moteus/moteus_trajectory.h"

namespace stilt::hal::moteus {

/// What a moteus does once its watchdog has expired, servo.timeout_mode; 15, phases shorted, is not modelled.
enum class MoteusTimeout : std::uint8_t {
  off = 0,
  hold_position = 10,  ///< comes to rest along its trajectory and holds, with all of its gains
  zero_velocity = 12,  ///< damps with the kd of the newest command
};

/// What a moteus keeps in its own configuration, by default as it comes from the vendor with firmware 1.1.0.
struct MoteusSettings {
  std::uint32_t firmware_version = 0x010100;
  std::uint32_t register_map_version = kMoteusRegisterMap;
  double kp_Nm_rev = 4;                                            ///< servo.pid_position.kp
  double ki = 1;                                                   ///< servo.pid_position.ki
  double ilimit_Nm = 0;                                            ///< servo.pid_position.ilimit
  double kd_Nm_s_rev = 0.05;                                       ///< servo.pid_position.kd
  double default_accel_limit_rev_s2 = 50;                          ///< servo, of firmware 1.0.0 on
  double default_velocity_limit_rev_s = MoteusTrajectory::kUnset;  ///< servo
  MoteusTrajectory::Bounds bounds{.minimum_rev = -0.01, .maximum_rev = 0.01};  ///< servopos
  double bemf_feedforward = 0;                                                 ///< servo
  MoteusTimeout timeout_mode = MoteusTimeout::zero_velocity;                   ///< servo
  double timeout_max_torque_Nm = 5;                                            ///< servo
  std::int64_t power_stage_ns = 4'500'000;  ///< polled every millisecond: 4 to 5 ms
  std::int64_t calibration_ns = 8'533'000;  ///< 256 samples of the current sensors' zero
  /// The firmware erases two pages of flash for a `conf write` (fw/stm32g4_flash.h), 22 ms each by the data
  /// sheet of the STM32G4 (DS12288). The rest, for programming, is an estimate.
  std::int64_t flash_ns = 60'000'000;
  bool answers_after_flash = false;  ///< the frame that carries `conf write`, too
  std::int64_t telemetry_ns = 0;     ///< between two texts that `tel rate` has asked for; 0: none
  bool telemetry_stops = true;       ///< at `tel stop`
};

/// Set up as docs/deployment.md says.
[[nodiscard]] constexpr MoteusSettings documented_settings(const MoteusDriver& driver) noexcept {
  MoteusSettings settings;
  settings.kp_Nm_rev = driver.kp_Nm_rev;
  settings.ki = 0;
  settings.kd_Nm_s_rev = driver.kd_Nm_s_rev;
  settings.bounds = {};
  return settings;
}

/// moteus: registers, trajectory, bounds, and the watchdog that latches mode `timeout` until a stop
/// arrives. From stopped to position mode takes the time of its power stage and its current sensors. The
/// power stage stays on for a while after a stop. A frame is answered before what it writes takes effect.
/// While it writes its flash it is deaf: three frames wait in its CAN controller, later ones are lost.
/// Facts: github.com/mjbots/moteus, fw/moteus_controller.cc, fw/bldc_servo_control.h, fw/bldc_servo.cc,
/// fw/drv8323.cc, fw/stm32g4_flash.h, fw/moteus.cc (db1a762); traces of that firmware: tests/data/traces.
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
  /// At power-up and now: what its encoders reference.
  void set_home(MoteusHome home) noexcept { home_ = home_at_power_up_ = home; }
  void set_encoder(std::size_t encoder, double position_rad, double velocity_rad_s) noexcept override {
    encoders_[encoder] = {position_rad, velocity_rad_s};
  }
  /// A firmware that does not keep the watchdog written to it.
  void ignore_watchdog(bool ignore) noexcept { ignore_watchdog_ = ignore; }
  void set_flash(std::int64_t duration_ns, bool answers_afterwards) noexcept {
    settings_.flash_ns = duration_ns;
    settings_.answers_after_flash = answers_afterwards;
  }

 private:
  struct Encoder {
    double position_rad = 0;
    double velocity_rad_s = 0;
  };
  static constexpr std::int64_t kCooldown_ns = 8'533'000;  ///< servo.cooldown_cycles
  static constexpr std::size_t kCommandRegisters = 10;
  using CommandRegisters = std::array<double, kCommandRegisters>;

  static double read(const void* context, std::uint32_t number) noexcept;
  static void write(void* context, std::uint32_t number, double value) noexcept;
  [[nodiscard]] double encoder_register(std::uint32_t offset) const noexcept;
  [[nodiscard]] double control_register(std::uint32_t number) const noexcept;
  [[nodiscard]] double position_error_rev() const noexcept;
  [[nodiscard]] double velocity_error_rev_s() const noexcept;
  [[nodiscard]] double damping_Nm() const noexcept;
  [[nodiscard]] double law_Nm(double kp_scale, double kd_scale) const noexcept;
  [[nodiscard]] bool drives() const noexcept;
  void apply(std::int64_t now_ns, MoteusMode wanted) noexcept;
  [[nodiscard]] bool take_console(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) noexcept;
  [[nodiscard]] ConsoleText setting(std::string_view name) const noexcept;
  [[nodiscard]] ConsoleText execute(std::int64_t now_ns, std::string_view line) noexcept;
  void report(std::int64_t now_ns) noexcept;
  void receive(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) noexcept;
  void serve(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) noexcept;
  void serve_waiting(std::int64_t now_ns, FrameSink& replies) noexcept;
  void begin_enabling(std::int64_t now_ns) noexcept;
  void turn_off(std::int64_t now_ns) noexcept;
  void aim() noexcept;
  void come_to_rest() noexcept;
  void advance(std::int64_t now_ns) noexcept;
  void enter_position_mode() noexcept;

  MoteusDriver driver_;
  MoteusSettings settings_;
  MoteusMode mode_ = MoteusMode::stopped;
  MoteusHome home_ = MoteusHome::output;  ///< of the output also after `d exact`
  MoteusHome home_at_power_up_ = MoteusHome::output;
  std::uint8_t fault_code_ = 0;
  CommandRegisters staged_{};   ///< registers 0x020 to 0x029 as the newest frame wrote them
  CommandRegisters command_{};  ///< in effect
  int staged_mode_ = -1;        ///< -1: the frame wrote none
  MoteusTrajectory trajectory_;
  double integral_Nm_ = 0;
  std::array<Encoder, kMoteusEncoders> encoders_{};
  bool ignore_watchdog_ = false;
  double written_zero_rad_ = 0;           ///< by conf write
  ConsoleText question_;                  ///< that its command line has so far
  std::array<ConsoleText, 2> answers_{};  ///< of its command line, one per reply: value, end of line
  std::int64_t deaf_until_ns_ = 0;
  std::array<CanFrame, 3> waiting_{};  ///< received while it was deaf
  std::size_t waiting_count_ = 0;
  std::optional<CanFrame> late_answer_;  ///< once it is no longer deaf
  std::int64_t next_telemetry_ns_ = 0;
  std::int64_t calibrating_from_ns_ = 0;
  std::int64_t power_stage_off_ns_ = 0;  ///< from then on
  std::int64_t last_command_ns_ = 0;
  std::int64_t advanced_ns_ = 0;
};

[[nodiscard]] inline MoteusEmulator make_emulator(const MoteusDriver& driver) noexcept {
  return MoteusEmulator(driver, documented_settings(driver));
}

}  // namespace stilt::hal::moteus
