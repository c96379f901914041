#include "hal/moteus/moteus_bring_up.h"

#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "hal/can/bytes.h"

namespace stilt::hal::moteus {
namespace {

using bring_up::BringUp;
using bring_up::Failure;
using bring_up::Setting;
using bring_up::Stage;

constexpr double kWatchdogTolerance_s = 0.0005;  // half a step of the register
constexpr double kProbe_rad = 0.5;               // about the position, without a travel
constexpr double kProbeVelocity_rad_s = 2;       // shows kd
/// The control position moves at that velocity between command and answer.
constexpr double kControlTolerance_rad = 0.1;
constexpr double kGainTolerance = 0.02;      // relative
constexpr double kTermTolerance_Nm = 0.005;  // beside it: registers of 1 mNm
/// Settings that no register shows, with the value that docs/deployment.md asks for.
struct WantedSetting {
  std::string_view question;
  double value;
  Setting setting;
};
constexpr std::array<WantedSetting, 2> kSettings{{
    {"conf get servo.timeout_mode", 12, Setting::moteus_timeout_mode},
    {"conf get servo.bemf_feedforward", 0, Setting::moteus_bemf_feedforward},
}};
constexpr std::uint8_t kOutsideBounds = 39;  // enabled outside servopos.position_min and position_max

/// A number as a driver writes it: digits, and perhaps a point among them.
std::optional<double> number(std::string_view text) noexcept {
  if (text.empty()) return std::nullopt;
  double value = 0;
  double place = 0;  // of the next digit behind the point; 0: none yet
  for (const char each : text) {
    if (each == '.' && place == 0) {
      place = 0.1;
    } else if (each < '0' || each > '9') {
      return std::nullopt;
    } else if (place == 0) {
      value = 10 * value + (each - '0');
    } else {
      value += place * (each - '0');
      place /= 10;
    }
  }
  return value;
}

/// Whether the command line has written a number, of any sign, and no other text.
bool is_value(std::string_view text) noexcept {
  return text == "nan" || text.starts_with('-') || number(text).has_value();
}

bool is_mode(const MoteusReply& reply, MoteusMode mode) noexcept {
  return reply.has_mode && reply.mode == static_cast<std::uint8_t>(mode);
}

/// Whether a term of the torque is that of a gain: kp and kd of the driver count in revolutions.
bool right_term(double torque_Nm, double error_rad, double gain_rev) noexcept {
  const double expected_Nm = std::abs(error_rad) / kRadiansPerRevolution * gain_rev;
  return std::abs(std::abs(torque_Nm) - expected_Nm) <= kGainTolerance * expected_Nm + kTermTolerance_Nm;
}

}  // namespace

BringUp::Ask MoteusBringUp::ask(Stage stage, unsigned /*part*/, CanFrame& frame) noexcept {
  EncodeStatus status = EncodeStatus::invalid;
  switch (stage) {
    case Stage::identify:
      setting_ = 0;
      console_.begin();
      status = encode_stop(driver_, MoteusQuery::identity, frame);
      break;
    case Stage::scaling:  // fixed by the register map version; gains show when it is enabled
      status = console_.ask(driver_, kSettings[setting_].question, tries() > 0, frame);
      break;
    case Stage::version:
    case Stage::watchdog_read:
      status = encode_query(driver_, MoteusQuery::identity, frame);
      break;
    case Stage::watchdog_write:
      status = encode_watchdog(driver_, options().watchdog_s, frame);
      break;
    case Stage::home:
      status = encode_query(driver_, MoteusQuery::state, frame);
      break;
    case Stage::enable:
    case Stage::ready:
    case Stage::failed:
      status = keep_alive(frame) ? EncodeStatus::ok : EncodeStatus::invalid;
      break;
  }
  if (status == EncodeStatus::ok) return Ask::wait_for_answer;
  failure(Failure::invalid);
  return Ask::fail;
}

BringUp::Verdict MoteusBringUp::wrong(Failure what, const Blame& blame) noexcept {
  failure(what, blame);
  return Verdict::fail;
}

BringUp::Verdict MoteusBringUp::judge_setting(const CanFrame& frame) noexcept {
  switch (console_.take(driver_, frame)) {
    case ConsoleReader::Progress::none:
      return Verdict::ignore;
    case ConsoleReader::Progress::more:
      return Verdict::next_part;
    case ConsoleReader::Progress::failed:
      return wrong(Failure::rejected, {.setting = Setting::moteus_command_line});
    case ConsoleReader::Progress::answer:
      break;
  }
  if (!is_value(console_.answer())) {
    return wrong(Failure::rejected, {.setting = Setting::moteus_command_line});
  }
  const WantedSetting& wanted = kSettings[setting_];
  if (number(console_.answer()) != wanted.value) {
    return wrong(Failure::wrong_setting, {.setting = wanted.setting});
  }
  return ++setting_ < kSettings.size() ? Verdict::next_part : Verdict::next_stage;
}

BringUp::Verdict MoteusBringUp::judge_version(const MoteusReply& reply) noexcept {
  if (!reply.has_firmware_version || !reply.has_register_map_version) return Verdict::ignore;
  if (reply.firmware_version < options().minimum_version) return wrong(Failure::old_version);
  if (reply.register_map_version < kMoteusRegisterMap) return wrong(Failure::old_version);
  if (reply.register_map_version > kMoteusRegisterMap) return wrong(Failure::wrong_scaling);
  output_referenced_ = reply.home == static_cast<std::uint8_t>(MoteusHome::output);
  rotor_referenced_ = reply.home == static_cast<std::uint8_t>(MoteusHome::rotor);
  return Verdict::next_stage;
}

BringUp::Verdict MoteusBringUp::judge_home(const MoteusReply& reply) noexcept {
  const bool one_turn = rotor_referenced_ && options().encoder_period_rad > 0;
  if (!output_referenced_ && !one_turn && turn_known()) return wrong(Failure::not_home);
  if (!std::isfinite(reply.position_rad)) return wrong(Failure::not_home);
  if (!check_home(reply.position_rad)) return Verdict::fail;
  if (!reaches_both_ends()) return wrong(Failure::wrong_setting, {.setting = Setting::moteus_zero});
  return Verdict::next_stage;
}

/// Only from mode position on do the driver's own bounds count.
BringUp::Verdict MoteusBringUp::judge_enabling(const MoteusReply& reply) noexcept {
  return is_mode(reply, MoteusMode::position) ? Verdict::next_part : Verdict::not_yet;
}

/// Of the travel, as the driver counts: there a probe asks it to hold.
double MoteusBringUp::end_rad(bool lower) const noexcept {
  const double travel_rad = lower ? options().minimum_angle_rad : options().maximum_angle_rad;
  const double near_rad = position_rad() + (lower ? -kProbe_rad : kProbe_rad);
  return (std::isfinite(travel_rad) ? travel_rad : near_rad) - turn_offset_rad();
}

/// Whether commands carry all of the travel. A driver may count from turns away, and the whole periods of
/// its encoder hide that from the travel alone.
bool MoteusBringUp::reaches_both_ends() const noexcept {
  return std::abs(end_rad(true)) <= kMoteusPosition_rad && std::abs(end_rad(false)) <= kMoteusPosition_rad;
}

/// The first setting that the answer to a probe contradicts. A control position that stands elsewhere is held
/// by bounds; one on its way, by limits of the trajectory.
Setting MoteusBringUp::contradicted(const MoteusReply& reply) noexcept {
  const double moved_rad = reply.control_position_rad - last_control_rad_;
  last_control_rad_ = reply.control_position_rad;
  if (!(std::abs(reply.control_position_rad - probed_rad()) <= kControlTolerance_rad)) {
    return moved_rad == 0 ? Setting::moteus_position_bounds : Setting::moteus_trajectory_limits;
  }
  if (!right_term(reply.proportional_Nm, reply.position_error_rad, driver_.kp_Nm_rev)) {
    return Setting::moteus_kp;
  }
  if (!right_term(reply.derivative_Nm, reply.velocity_error_rad_s, driver_.kd_Nm_s_rev)) {
    return Setting::moteus_kd;
  }
  return std::abs(reply.integral_Nm) <= kTermTolerance_Nm ? Setting::none : Setting::moteus_ki;
}

/// The first answer still shows what was before the probe.
BringUp::Verdict MoteusBringUp::judge_probe(const MoteusReply& reply) noexcept {
  if (!reply.has_control || !std::isfinite(reply.control_position_rad)) return Verdict::ignore;
  const Setting setting = contradicted(reply);
  if (setting != Setting::none) {
    const bool gain = setting == Setting::moteus_kp || setting == Setting::moteus_kd;
    suspect(gain ? Failure::wrong_scaling : Failure::wrong_setting, {.setting = setting});
    return Verdict::not_yet;
  }
  return part() == kUpperEnd ? Verdict::next_stage : Verdict::next_part;
}

BringUp::Verdict MoteusBringUp::judge(Stage stage, unsigned part, const CanFrame& frame) noexcept {
  if (stage == Stage::scaling) return judge_setting(frame);
  MoteusReply reply;
  if (decode_reply(driver_, frame, reply) != DecodeStatus::ok || !reply.has_mode) return Verdict::ignore;
  if (is_mode(reply, MoteusMode::fault)) {
    const DriverFault fault = moteus_fault(reply.fault_code);
    const bool bounds = stage == Stage::enable && reply.fault_code == kOutsideBounds;
    const Blame blame{fault, reply.fault_code, bounds ? Setting::moteus_position_bounds : Setting::none};
    if (stage != Stage::identify) return wrong(Failure::driver_fault, blame);
    suspect(Failure::driver_fault, blame);  // the stop that is answered here clears it
    return Verdict::not_yet;
  }
  switch (stage) {
    case Stage::identify:
      return is_mode(reply, MoteusMode::stopped) ? Verdict::next_stage : Verdict::not_yet;
    case Stage::version:
      return judge_version(reply);
    case Stage::watchdog_write:
      return Verdict::next_stage;
    case Stage::watchdog_read:
      if (!(std::abs(reply.watchdog_s - options().watchdog_s) <= kWatchdogTolerance_s)) {
        return wrong(std::isnan(reply.watchdog_s) ? Failure::no_watchdog : Failure::wrong_watchdog);
      }
      return Verdict::next_stage;
    case Stage::home:
      return judge_home(reply);
    case Stage::enable:
      return part < kLowerEnd ? judge_enabling(reply) : judge_probe(reply);
    case Stage::scaling:
    case Stage::ready:
    case Stage::failed:
      break;
  }
  return Verdict::ignore;
}

/// Zero torque whatever else is asked.
bool MoteusBringUp::keep_alive(CanFrame& frame) noexcept {
  MoteusCommand limp;
  limp.maximum_torque_Nm = 0;
  limp.watchdog_s = options().watchdog_s;
  if (stage() != Stage::enable || part() < kLowerEnd) {
    return encode_command(driver_, limp, frame) == EncodeStatus::ok;
  }
  limp.position_rad = probed_rad();
  limp.velocity_rad_s = kProbeVelocity_rad_s;
  limp.kp_Nm_rad = driver_.kp_Nm_rev / kRadiansPerRevolution;
  limp.kd_Nms_rad = driver_.kd_Nm_s_rev / kRadiansPerRevolution;
  return encode_command(driver_, limp, frame, MoteusQuery::control) == EncodeStatus::ok;
}

}  // namespace stilt::hal::moteus
