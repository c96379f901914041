#include "hal/moteus/moteus_emulator.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hal/can/bytes.h"

namespace stilt::hal::moteus {
namespace {

constexpr std::uint32_t kFirstCommand = static_cast<std::uint32_t>(MoteusRegister::command_position);
constexpr std::uint32_t kFirstEncoder = static_cast<std::uint32_t>(MoteusRegister::encoder_0_position);
constexpr std::uint32_t kFirstControl = static_cast<std::uint32_t>(MoteusRegister::proportional);
constexpr std::uint32_t kLastControl = static_cast<std::uint32_t>(MoteusRegister::velocity_error);
constexpr std::size_t kPosition = 0, kVelocity = 1, kTorque = 2, kKpScale = 3, kKdScale = 4,
                      kMaximumTorque = 5, kTimeout = 7, kVelocityLimit = 8, kAccelLimit = 9;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Values of registers that a command leaves out.
constexpr std::array<double, 10> kUnspecified{kNaN, 0, 0, 1, 1, kNaN, kNaN, 0, kNaN, kNaN};
constexpr double kDefaultTimeout_s = 0.1;
constexpr double kDerate_rev = 0.02;                   // beyond its bounds: torque outwards fades over this
constexpr std::uint8_t kStartOutsideLimit = 39;        // position mode outside its bounds
constexpr std::uint8_t kFeedforwardWithoutLimit = 47;  // of the acceleration

/// A limit of a trajectory: unset is the driver's own, negative none.
double limit_of(double commanded, double configured) noexcept {
  if (std::isnan(commanded)) return configured;
  return commanded < 0 ? kNaN : commanded;
}

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

MoteusEmulator::MoteusEmulator(const MoteusDriver& driver, const MoteusSettings& settings) noexcept
    : driver_(driver), settings_(settings), staged_(kUnspecified), command_(kUnspecified) {}

void MoteusEmulator::power_cycle() noexcept {
  mode_ = MoteusMode::stopped;
  fault_code_ = 0;
  power_stage_off_ns_ = 0;
  question_.clear();
  answers_ = {};
  settings_.telemetry_ns = 0;
  deaf_until_ns_ = 0;
  waiting_count_ = 0;
  late_answer_.reset();
  staged_ = command_ = kUnspecified;
  set_zero_rad(written_zero_rad_);
  home_ = home_at_power_up_;
}

void MoteusEmulator::raise(DriverFault fault) noexcept {
  mode_ = MoteusMode::fault;
  fault_code_ = code_of(fault);
}

double MoteusEmulator::position_error_rev() const noexcept {
  return sensed().position_rad / kRadiansPerRevolution - trajectory_.position_rev();
}

double MoteusEmulator::velocity_error_rev_s() const noexcept {
  return sensed().velocity_rad_s / kRadiansPerRevolution - trajectory_.velocity_rev_s();
}

/// With the kd of the newest command.
double MoteusEmulator::damping_Nm() const noexcept {
  const double most_Nm = settings_.timeout_max_torque_Nm;
  const double velocity_rev_s = sensed().velocity_rad_s / kRadiansPerRevolution;
  return std::clamp(-command_[kKdScale] * settings_.kd_Nm_s_rev * velocity_rev_s, -most_Nm, most_Nm);
}

double MoteusEmulator::law_Nm(double kp_scale, double kd_scale) const noexcept {
  return -integral_Nm_ - kp_scale * settings_.kp_Nm_rev * position_error_rev() -
         kd_scale * settings_.kd_Nm_s_rev * velocity_error_rev_s();
}

/// Its power stage carries current.
bool MoteusEmulator::drives() const noexcept {
  return mode_ == MoteusMode::position || mode_ == MoteusMode::zero_velocity ||
         (mode_ == MoteusMode::timeout && settings_.timeout_mode != MoteusTimeout::off);
}

double MoteusEmulator::torque_Nm() const noexcept {
  if (!gives_torque() || !drives()) return 0;
  if (mode_ == MoteusMode::timeout && settings_.timeout_mode == MoteusTimeout::hold_position) {
    return law_Nm(1, 1);
  }
  if (mode_ != MoteusMode::position) return damping_Nm();
  double torque_Nm = command_[kTorque] + law_Nm(command_[kKpScale], command_[kKdScale]);
  const double limit_Nm = std::abs(command_[kMaximumTorque]);
  if (!std::isnan(limit_Nm)) torque_Nm = std::clamp(torque_Nm, -limit_Nm, limit_Nm);
  const double position_rev = sensed().position_rad / kRadiansPerRevolution;
  const double beyond_rev = torque_Nm > 0 ? position_rev - settings_.bounds.maximum_rev
                                          : settings_.bounds.minimum_rev - position_rev;
  return beyond_rev > 0 ? torque_Nm * std::max(0.0, 1 - beyond_rev / kDerate_rev) : torque_Nm;
}

/// Terms of the torque before its limit, and what they come from.
double MoteusEmulator::control_register(std::uint32_t number) const noexcept {
  const bool active = mode_ == MoteusMode::position && trajectory_.started();
  switch (static_cast<MoteusRegister>(number)) {
    case MoteusRegister::proportional:
      return active ? command_[kKpScale] * settings_.kp_Nm_rev * position_error_rev() : 0;
    case MoteusRegister::integral:
      return active ? integral_Nm_ : 0;
    case MoteusRegister::derivative:
      return active ? command_[kKdScale] * settings_.kd_Nm_s_rev * velocity_error_rev_s() : 0;
    case MoteusRegister::control_position:
      return active ? trajectory_.position_rev() : kNaN;
    case MoteusRegister::position_error:
      return active ? position_error_rev() : 0;
    case MoteusRegister::velocity_error:
      return active ? velocity_error_rev_s() : 0;
    default:
      return 0;
  }
}

double MoteusEmulator::encoder_register(std::uint32_t offset) const noexcept {
  const Encoder& encoder = encoders_[offset / 2];
  return (offset % 2 == 0 ? encoder.position_rad : encoder.velocity_rad_s) / kRadiansPerRevolution;
}

double MoteusEmulator::read(const void* context, std::uint32_t number) noexcept {
  const auto& driver = *static_cast<const MoteusEmulator*>(context);
  if (number >= kFirstCommand && number < kFirstCommand + kCommandRegisters) {
    return driver.staged_[number - kFirstCommand];
  }
  if (number >= kFirstControl && number <= kLastControl) return driver.control_register(number);
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
    case MoteusRegister::motor_temperature:
      return driver.motor.temperature_C;
    case MoteusRegister::fault:
      return driver.fault_code_;
    case MoteusRegister::firmware_version:
      return driver.settings_.firmware_version;
    case MoteusRegister::register_map_version:
      return driver.settings_.register_map_version;
    default:
      return 0;
  }
}

void MoteusEmulator::write(void* context, std::uint32_t number, double value) noexcept {
  auto& driver = *static_cast<MoteusEmulator*>(context);
  if (number == static_cast<std::uint32_t>(MoteusRegister::mode)) {
    if (!(value >= 0 && value <= 255)) return;
    driver.staged_mode_ = static_cast<int>(value);
    driver.staged_ = kUnspecified;  // a command contains every value that differs from its default
    return;
  }
  if (number < kFirstCommand || number >= kFirstCommand + kCommandRegisters) return;
  if (number - kFirstCommand == kTimeout && driver.ignore_watchdog_) return;
  driver.staged_[number - kFirstCommand] = value;
}

/// The power stage of a motor that was driven stays on until the current has gone.
void MoteusEmulator::turn_off(std::int64_t now_ns) noexcept {
  if (drives()) power_stage_off_ns_ = now_ns + kCooldown_ns;
  mode_ = MoteusMode::stopped;
  fault_code_ = 0;
}

void MoteusEmulator::begin_enabling(std::int64_t now_ns) noexcept {
  constexpr std::int64_t kPoll_ns = 500'000;  // half a millisecond
  mode_ = MoteusMode::enabling;
  calibrating_from_ns_ = now_ns + (now_ns < power_stage_off_ns_ ? kPoll_ns : settings_.power_stage_ns);
}

/// After the frame was answered.
void MoteusEmulator::apply(std::int64_t now_ns, MoteusMode wanted) noexcept {
  command_ = staged_;
  last_command_ns_ = now_ns;
  const double accel_limit = limit_of(command_[kAccelLimit], settings_.default_accel_limit_rev_s2);
  if (wanted == MoteusMode::stopped) {
    turn_off(now_ns);
  } else if (settings_.bemf_feedforward != 0 && std::isnan(accel_limit)) {
    mode_ = MoteusMode::fault;
    fault_code_ = kFeedforwardWithoutLimit;
  } else if (mode_ == MoteusMode::stopped) {
    begin_enabling(now_ns);
  } else if (mode_ == MoteusMode::position || mode_ == MoteusMode::zero_velocity) {
    mode_ = wanted;
  }
  aim();
}

void MoteusEmulator::aim() noexcept {
  trajectory_.aim(
      {.position_rev = command_[kPosition],
       .velocity_rev_s = std::isnan(command_[kVelocity]) ? 0 : command_[kVelocity],
       .velocity_limit_rev_s = limit_of(command_[kVelocityLimit], settings_.default_velocity_limit_rev_s),
       .accel_limit_rev_s2 = limit_of(command_[kAccelLimit], settings_.default_accel_limit_rev_s2)});
}

/// As its watchdog expires, with its own limits.
void MoteusEmulator::come_to_rest() noexcept {
  trajectory_.aim({.velocity_limit_rev_s = settings_.default_velocity_limit_rev_s,
                   .accel_limit_rev_s2 = settings_.default_accel_limit_rev_s2});
}

void MoteusEmulator::enter_position_mode() noexcept {
  const double position_rev = sensed().position_rad / kRadiansPerRevolution;
  if (position_rev < settings_.bounds.minimum_rev || position_rev > settings_.bounds.maximum_rev) {
    mode_ = MoteusMode::fault;
    fault_code_ = kStartOutsideLimit;
    return;
  }
  mode_ = MoteusMode::position;
  integral_Nm_ = 0;
  trajectory_.end();
  aim();
}

/// The trajectory, and the integral of its error.
void MoteusEmulator::advance(std::int64_t now_ns) noexcept {
  const double passed_s = static_cast<double>(now_ns - advanced_ns_) * 1e-9;
  advanced_ns_ = now_ns;
  const bool holds = mode_ == MoteusMode::timeout && settings_.timeout_mode == MoteusTimeout::hold_position;
  if (mode_ != MoteusMode::position && !holds) return;
  trajectory_.advance(passed_s, sensed().position_rad / kRadiansPerRevolution,
                      sensed().velocity_rad_s / kRadiansPerRevolution, settings_.bounds);
  integral_Nm_ = std::clamp(integral_Nm_ + settings_.ki * position_error_rev() * passed_s,
                            -settings_.ilimit_Nm, settings_.ilimit_Nm);
}

void MoteusEmulator::take(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) noexcept {
  if (!powered()) return;
  elapse(now_ns, replies);
  receive(now_ns, frame, replies);
}

void MoteusEmulator::receive(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) noexcept {
  if (now_ns >= deaf_until_ns_) {
    serve(now_ns, frame, replies);
  } else if (waiting_count_ < waiting_.size() && is_frame_to(driver_, frame)) {
    waiting_[waiting_count_++] = frame;
  }
}

/// Once it is no longer deaf.
void MoteusEmulator::serve_waiting(std::int64_t now_ns, FrameSink& replies) noexcept {
  if (now_ns < deaf_until_ns_ || !powered()) return;
  if (late_answer_) replies.push(*late_answer_);
  late_answer_.reset();
  const std::array<CanFrame, 3> frames = waiting_;
  const std::size_t count = waiting_count_;
  waiting_count_ = 0;
  for (std::size_t frame = 0; frame < count; ++frame) receive(now_ns, frames[frame], replies);
}

void MoteusEmulator::serve(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) noexcept {
  if (take_console(now_ns, frame, replies)) return;
  staged_mode_ = -1;
  CanFrame answer;
  bool answered = false;
  if (serve_frame(driver_, frame, this, read, write, answer, answered) != DecodeStatus::ok) return;
  if (staged_mode_ >= 0) {
    apply(now_ns, static_cast<MoteusMode>(staged_mode_));
    advance(now_ns);
  }
  if (answered) replies.push(answer);
}

/// The watchdog runs from the newest command on, in position mode and on the way there.
void MoteusEmulator::elapse(std::int64_t now_ns, FrameSink& replies) noexcept {
  serve_waiting(now_ns, replies);
  if (mode_ == MoteusMode::enabling && now_ns >= calibrating_from_ns_) mode_ = MoteusMode::calibrating;
  if (mode_ == MoteusMode::calibrating && now_ns >= calibrating_from_ns_ + settings_.calibration_ns) {
    enter_position_mode();
    advanced_ns_ = now_ns;
  }
  advance(now_ns);
  if (mode_ != MoteusMode::position || std::isnan(command_[kTimeout])) return;
  const double allowed_s = command_[kTimeout] > 0 ? command_[kTimeout] : kDefaultTimeout_s;
  if (static_cast<double>(now_ns - last_command_ns_) * 1e-9 <= allowed_s) return;
  mode_ = MoteusMode::timeout;
  come_to_rest();
}

}  // namespace stilt::hal::moteus
