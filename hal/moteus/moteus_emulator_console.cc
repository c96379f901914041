#include <algorithm>
#include <cstdio>
#include <iterator>

#include "hal/moteus/moteus_emulator.h"

// The command line of the emulated driver.
namespace stilt::hal::moteus {

/// As the command line writes it.
ConsoleText MoteusEmulator::setting(std::string_view name) const noexcept {
  const auto mode = static_cast<double>(settings_.timeout_mode);
  struct Named {
    std::string_view name;
    double value;
    const char* format = "%f";
  };
  const Named named[] = {
      {"servo.pid_position.kp", settings_.kp_Nm_rev},
      {"servo.pid_position.ki", settings_.ki},
      {"servo.pid_position.kd", settings_.kd_Nm_s_rev},
      {"servopos.position_min", settings_.bounds.minimum_rev},
      {"servopos.position_max", settings_.bounds.maximum_rev},
      {"servo.default_velocity_limit", settings_.default_velocity_limit_rev_s},
      {"servo.default_accel_limit", settings_.default_accel_limit_rev_s2},
      {"servo.bemf_feedforward", settings_.bemf_feedforward},
      {"servo.timeout_mode", mode, "%.0f"},
      {"servo.timeout_max_torque_Nm", settings_.timeout_max_torque_Nm},
  };
  ConsoleText text;
  const auto* const found = std::ranges::find(named, name, &Named::name);
  if (found == std::end(named)) {
    text.append("ERR error reading");
    return text;
  }
  char digits[32];
  std::snprintf(digits, sizeof digits, found->format, found->value);
  text.append(digits);
  return text;
}

/// A line of the command line: its answer without its end.
ConsoleText MoteusEmulator::execute(std::int64_t now_ns, std::string_view line) noexcept {
  constexpr std::string_view kGet = "conf get ";
  if (line == "conf write") {
    written_zero_rad_ = zero_rad();
    deaf_until_ns_ = now_ns + settings_.flash_ns;
  } else if (line == "tel stop") {
    if (settings_.telemetry_stops) settings_.telemetry_ns = 0;
  } else if (line == "d cfg-set-output 0" || line == "d exact 0") {
    count_from(0);
    if (line == "d exact 0") home_ = MoteusHome::output;
  } else {
    return setting(line.starts_with(kGet) ? line.substr(kGet.size()) : "");
  }
  ConsoleText text;
  text.append("OK");
  return text;
}

/// What `tel rate` has asked for, between two answers.
void MoteusEmulator::report(std::int64_t now_ns) noexcept {
  const bool due = settings_.telemetry_ns > 0 && now_ns >= next_telemetry_ns_;
  if (!due || !answers_[0].view().empty()) return;
  next_telemetry_ns_ = now_ns + settings_.telemetry_ns;
  answers_[0].append("emit servo_stats\r\n");
  answers_[1].append("\x01\x02\x03");
}

/// Answered by a later reply, a part at a time.
bool MoteusEmulator::take_console(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) noexcept {
  const std::optional<ConsoleText> text = decode_console_request(driver_, frame);
  if (!text) return false;
  CanFrame answer;
  report(now_ns);
  if (encode_console_answer(driver_, frame, answers_[0].view(), answer) != EncodeStatus::ok) return true;
  answers_ = {answers_[1], ConsoleText{}};
  question_.append(text->view());
  if (question_.view().ends_with('\n')) {
    std::string_view line = question_.view();
    line.remove_suffix(1);
    answers_[0] = execute(now_ns, line);
    answers_[1].clear();
    answers_[1].append("\r\n");
    question_.clear();
  }
  if (now_ns < deaf_until_ns_ && settings_.answers_after_flash) {
    late_answer_ = answer;
  } else {
    replies.push(answer);
  }
  return true;
}

}  // namespace stilt::hal::moteus
