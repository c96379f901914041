#include "hal/moteus/moteus_emulator.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hal/can/bytes.h"

namespace stilt::hal::moteus {
namespace {

constexpr std::uint32_t kFirstCommand = static_cast<std::uint32_t>(MoteusRegister::command_position);
constexpr std::uint32_t kFirstEncoder = static_cast<std::uint32_t>(MoteusRegister::encoder_0_position);
constexpr std::size_t kPosition = 0, kVelocity = 1, kTorque = 2, kKpScale = 3, kKdScale = 4,
                      kMaximumTorque = 5;
constexpr std::size_t kTimeout = 7;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Values of registers that a command leaves out.
constexpr std::array<double, 8> kUnspecified{0, 0, 0, 1, 1, kNaN, kNaN, 0};
constexpr double kDefaultTimeout_s = 0.1;

std::uint8_t code_of(DriverFault fault) noexcept {
  switch (fault) {
    case DriverFault::gate_driver:
      return 33;
    case DriverFault::over_voltage:
      return 34;
    case DriverFault::encoder:
      return 35;
    case DriverFault::configuration:
      return 36;
    case DriverFault::driver_over_temperature:
      return 38;
    case DriverFault::position_limit:
      return 39;
    case DriverFault::under_voltage:
      return 40;
    default:
      return 37;
  }
}

}  // namespace

MoteusEmulator::MoteusEmulator(const MoteusDriver& driver, std::uint32_t firmware_version) noexcept
    : driver_(driver), firmware_version_(firmware_version), command_(kUnspecified) {}

void MoteusEmulator::power_cycle() noexcept {
  mode_ = MoteusMode::stopped;
  fault_code_ = 0;
  command_ = kUnspecified;
}

void MoteusEmulator::raise(DriverFault fault) noexcept {
  mode_ = MoteusMode::fault;
  fault_code_ = code_of(fault);
}

double MoteusEmulator::torque_Nm() const noexcept {
  if (!powered()) return 0;
  const double velocity_rev_s = sensed().velocity_rad_s / kRadiansPerRevolution;
  if (mode_ == MoteusMode::timeout || mode_ == MoteusMode::zero_velocity)
    return -driver_.kd_Nm_s_rev * velocity_rev_s;
  if (mode_ != MoteusMode::position) return 0;
  const double error_rev = std::isnan(command_[kPosition])
                               ? 0
                               : command_[kPosition] - sensed().position_rad / kRadiansPerRevolution;
  const double torque_Nm = command_[kKpScale] * driver_.kp_Nm_rev * error_rev +
                           command_[kKdScale] * driver_.kd_Nm_s_rev * (command_[kVelocity] - velocity_rev_s) +
                           command_[kTorque];
  const double limit_Nm = command_[kMaximumTorque];
  return std::isnan(limit_Nm) ? torque_Nm : std::clamp(torque_Nm, -std::abs(limit_Nm), std::abs(limit_Nm));
}

double MoteusEmulator::encoder_register(std::uint32_t offset) const noexcept {
  const Encoder& encoder = encoders_[offset / 2];
  return (offset % 2 == 0 ? encoder.position_rad : encoder.velocity_rad_s) / kRadiansPerRevolution;
}

double MoteusEmulator::read(const void* context, std::uint32_t number) noexcept {
  const auto& driver = *static_cast<const MoteusEmulator*>(context);
  if (number >= kFirstCommand && number < kFirstCommand + driver.command_.size()) {
    return driver.command_[number - kFirstCommand];
  }
  if (number >= kFirstEncoder && number < kFirstEncoder + 2 * kMoteusEncoders) {
    return driver.encoder_register(number - kFirstEncoder);
  }
  switch (static_cast<MoteusRegister>(number)) {
    case MoteusRegister::mode:
      return static_cast<double>(driver.mode_);
    case MoteusRegister::position:
      return driver.sensed().position_rad / kRadiansPerRevolution;
    case MoteusRegister::velocity:
      return driver.sensed().velocity_rad_s / kRadiansPerRevolution;
    case MoteusRegister::torque:
      return driver.torque_Nm();
    case MoteusRegister::home_state:
      return static_cast<double>(driver.home_);
    case MoteusRegister::voltage:
      return driver.motor.supply_V;
    case MoteusRegister::temperature:
      return driver.motor.temperature_C;
    case MoteusRegister::fault:
      return driver.fault_code_;
    case MoteusRegister::firmware_version:
      return driver.firmware_version_;
    case MoteusRegister::register_map_version:
      return 5;
    default:
      return 0;
  }
}

void MoteusEmulator::write(void* context, std::uint32_t number, double value) noexcept {
  auto& driver = *static_cast<MoteusEmulator*>(context);
  if (number == static_cast<std::uint32_t>(MoteusRegister::mode)) {
    if (!(value >= 0 && value <= 255)) return;
    const auto wanted = static_cast<MoteusMode>(static_cast<std::uint8_t>(value));
    if (wanted == MoteusMode::stopped) {
      driver.mode_ = MoteusMode::stopped;
      driver.fault_code_ = 0;
    } else if (driver.mode_ != MoteusMode::fault && driver.mode_ != MoteusMode::timeout) {
      driver.mode_ = wanted;
    }
    driver.command_ = kUnspecified;  // a command names everything it does not want at its default
    return;
  }
  if (number < kFirstCommand || number >= kFirstCommand + driver.command_.size()) return;
  if (number - kFirstCommand == kTimeout && driver.ignore_watchdog_) return;
  driver.command_[number - kFirstCommand] = value;
}

void MoteusEmulator::take(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) noexcept {
  if (!powered()) return;
  CanFrame answer;
  bool answered = false;
  if (serve_frame(driver_, frame, this, read, write, answer, answered) != DecodeStatus::ok) return;
  last_command_ns_ = now_ns;
  if (answered) replies.push(answer);
}

void MoteusEmulator::elapse(std::int64_t now_ns, FrameSink& /*replies*/) noexcept {
  if (mode_ != MoteusMode::position || std::isnan(command_[kTimeout])) return;
  const double allowed_s = command_[kTimeout] > 0 ? command_[kTimeout] : kDefaultTimeout_s;
  if (static_cast<double>(now_ns - last_command_ns_) * 1e-9 > allowed_s) mode_ = MoteusMode::timeout;
}

}  // namespace stilt::hal::moteus
