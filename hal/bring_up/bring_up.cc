#include "hal/bring_up/bring_up.h"

#include <algorithm>
#include <cmath>

#include "hal/bring_up/absolute_turn.h"

namespace stilt::hal::bring_up {
namespace {

/// A step that comes later counts as one of so long: a program that stood still has asked nothing meanwhile.
constexpr std::int64_t kLongestStep_ns = 2'000'000;
constexpr double kShortestWatchdog_s = 0.005;
constexpr double kLongestWatchdog_s = 0.1;

bool valid(const Options& options) noexcept {
  return options.watchdog_s >= kShortestWatchdog_s && options.watchdog_s <= kLongestWatchdog_s &&
         options.tries > 0 && options.answer_timeout_ns > 0 && options.longest_reply_lag_ns > 0 &&
         options.minimum_angle_rad <= options.maximum_angle_rad && options.encoder_period_rad >= 0;
}

}  // namespace

const char* name(Stage stage) noexcept {
  switch (stage) {
    case Stage::identify:
      return "identify";
    case Stage::version:
      return "version";
    case Stage::scaling:
      return "scaling";
    case Stage::watchdog_write:
      return "write watchdog";
    case Stage::watchdog_read:
      return "read watchdog";
    case Stage::home:
      return "home";
    case Stage::enable:
      return "enable";
    case Stage::ready:
      return "ready";
    case Stage::failed:
      return "failed";
  }
  return "unknown";
}

const char* name(Failure failure) noexcept {
  switch (failure) {
    case Failure::none:
      return "none";
    case Failure::invalid:
      return "invalid configuration";
    case Failure::silent:
      return "no answer";
    case Failure::rejected:
      return "does not do what it is asked";
    case Failure::wrong_identity:
      return "another driver answers";
    case Failure::old_version:
      return "firmware too old";
    case Failure::wrong_scaling:
      return "scaling differs from the configuration";
    case Failure::no_watchdog:
      return "has no watchdog";
    case Failure::wrong_watchdog:
      return "watchdog is not the one that was set";
    case Failure::not_home:
      return "position not referenced";
    case Failure::driver_fault:
      return "driver fault";
    case Failure::wrong_setting:
      return "a setting of the driver is wrong";
    case Failure::slow_reply:
      return "replies come too late";
    case Failure::void_offsets:
      return "its offset is void";
    case Failure::wrong_version:
      return "version differs from the configuration";
  }
  return "unknown";
}

void BringUp::restart() noexcept {
  losses_ = 0;
  begin_anew();
}

void BringUp::begin_anew() noexcept {
  stage_ = Stage::identify;
  failure_ = suspected_ = Failure::none;
  blame_ = suspicion_ = {};
  part_ = tries_ = 0;
  waiting_ = answered_ = failing_ = false;
  position_rad_ = std::numeric_limits<double>::quiet_NaN();
  turn_offset_rad_ = 0;
  reply_lag_ns_ = 0;
  lag_probes_ = 0;
  begins_rest_ = false;
  rest_until_ns_ = 0;
  stage_ns_ = 0;
}

/// Until replies to what was sent before are over.
void BringUp::rest() noexcept {
  part_ = tries_ = 0;
  waiting_ = false;
  begins_rest_ = true;
}

bool BringUp::resting() noexcept {
  if (begins_rest_) rest_until_ns_ = now_ns_ + kRest_ns;
  begins_rest_ = false;
  return now_ns_ < rest_until_ns_;
}

bool BringUp::measures_lag() const noexcept {
  return stage_ == lag_stage() && (reply_lag_ns_ == 0 || lag_probes_ > 0);
}

/// At the answer to the first request. One that was late is asked again after a rest: a frame may be lost,
/// and the computer may have been late.
bool BringUp::replies_in_time() noexcept {
  const std::int64_t lag_ns = now_ns_ - asked_ns_;
  reply_lag_ns_ = reply_lag_ns_ == 0 ? lag_ns : std::min(reply_lag_ns_, lag_ns);
  if (reply_lag_ns_ <= options_.longest_reply_lag_ns) return true;
  if (++lag_probes_ == kLagProbes) {
    failure(Failure::slow_reply);
  } else {
    rest();
  }
  return false;
}

void BringUp::failure(Failure failure, const Blame& blame) noexcept {
  failure_ = failure;
  blame_ = blame;
  waiting_ = begins_rest_ = false;
  failing_ = true;
  part_ = 0;
}

void BringUp::suspect(Failure failure, const Blame& blame) noexcept {
  suspected_ = failure;
  suspicion_ = blame;
}

/// All tries of a request are over, or the stage has lasted too long.
void BringUp::give_up() noexcept {
  if (suspected_ != Failure::none) {
    failure(suspected_, suspicion_);
  } else {
    failure(answered_ || tries_ < options_.tries ? Failure::rejected : Failure::silent);
  }
}

bool BringUp::check_home(double position_rad) noexcept {
  double placed_rad = position_rad;
  const bool all_turns = any_turn(options_.minimum_angle_rad, options_.maximum_angle_rad);
  if (options_.encoder_period_rad > 0 && !all_turns) {
    const auto turn = only_turn(position_rad, options_.encoder_period_rad, options_.minimum_angle_rad,
                                options_.maximum_angle_rad);
    placed_rad = turn.value_or(std::numeric_limits<double>::quiet_NaN());
  }
  if (!(placed_rad >= options_.minimum_angle_rad && placed_rad <= options_.maximum_angle_rad)) {
    failure(Failure::not_home);
    return false;
  }
  position_rad_ = placed_rad;
  turn_offset_rad_ = placed_rad - position_rad;
  return true;
}

void BringUp::advance() noexcept {
  stage_ = static_cast<Stage>(static_cast<std::uint8_t>(stage_) + 1);
  part_ = tries_ = 0;
  waiting_ = answered_ = false;
  suspected_ = Failure::none;
  silent_ns_ = 0;
  stage_ns_ = 0;
  if (stage_ == lag_stage()) rest();
}

/// While other drivers come up, one that is ready may lose what it was given: its answers still judge whether
/// it is enabled.
void BringUp::watch(std::span<const CanFrame> received, std::int64_t since_last_step_ns) noexcept {
  bool lost = false;
  silent_ns_ += since_last_step_ns;
  for (const CanFrame& frame : received) {
    switch (judge(Stage::enable, 0, frame)) {
      case Verdict::ignore:
      case Verdict::fail:
        break;
      case Verdict::next_part:
      case Verdict::next_stage:
        silent_ns_ = 0;
        break;
      case Verdict::not_yet:
      case Verdict::first_part:
        lost = true;
        break;
    }
  }
  if (stage_ != Stage::ready || (!lost && silent_ns_ <= longest_silence_ns())) return;
  if (++losses_ > options_.tries) {
    failure(lost ? Failure::rejected : Failure::silent);
  } else {
    begin_anew();
  }
}

void BringUp::take(const CanFrame& frame) noexcept {
  const bool measures = measures_lag();
  const Verdict verdict = judge(stage_, part_, frame);
  if (measures && verdict != Verdict::ignore && verdict != Verdict::fail) {
    if (!replies_in_time()) return;
    lag_probes_ = 0;
  }
  switch (verdict) {
    case Verdict::ignore:
    case Verdict::fail:
      break;
    case Verdict::not_yet:
      answered_ = true;
      break;
    case Verdict::first_part:
      answered_ = true;
      part_ = 0;
      waiting_ = false;
      break;
    case Verdict::next_part:
      ++part_;
      tries_ = 0;
      waiting_ = answered_ = false;
      suspected_ = Failure::none;
      break;
    case Verdict::next_stage:
      advance();
      break;
  }
}

StepResult BringUp::result() const noexcept {
  StepResult result;
  result.stage = stage_;
  result.failure = failure_;
  result.driver_fault = blame_.fault;
  result.fault_code = blame_.fault_code;
  result.setting = blame_.setting;
  result.version = blame_.version;
  result.wanted_version = blame_.wanted_version;
  result.position_rad = position_rad_;
  result.turn_offset_rad = turn_offset_rad_;
  result.reply_lag_ns = reply_lag_ns_;
  return result;
}

StepResult BringUp::result_with_keep_alive(bool wanted) noexcept {
  StepResult settled = result();
  settled.send = wanted && keep_alive(settled.frame);
  return settled;
}

StepResult BringUp::step(std::int64_t now_ns, std::span<const CanFrame> received) noexcept {
  const StepResult proceeded = failing_ ? result() : proceed(now_ns, received);
  if (!failing_) return proceeded;
  StepResult undoing = result();
  undoing.send = undo(part_++, undoing.frame);
  if (undoing.send) return undoing;
  failing_ = false;
  stage_ = Stage::failed;
  return result();
}

StepResult BringUp::proceed(std::int64_t now_ns, std::span<const CanFrame> received) noexcept {
  const std::int64_t since_last_step_ns = std::min(now_ns - now_ns_, kLongestStep_ns);
  now_ns_ = now_ns;
  stage_ns_ += since_last_step_ns;
  if (stage_ != Stage::failed && !valid(options_)) failure(Failure::invalid);
  if (stage_ == Stage::ready) {
    watch(received, since_last_step_ns);
    received = {};
  }
  if (stage_ < Stage::ready && resting()) return result();
  for (const CanFrame& frame : received) {
    if (waiting_) take(frame);
  }
  if (begins_rest_) return result();
  if (waiting_ && now_ns < deadline_ns_) return result_with_keep_alive(stage_ == Stage::enable);
  CanFrame frame;
  while (stage_ < Stage::ready && !failing_) {
    if (tries_ == options_.tries || stage_ns_ > kLongestStage_ns) {
      give_up();
      break;
    }
    const Ask asked = ask(stage_, part_, frame);
    if (asked == Ask::fail) break;
    if (asked == Ask::skip) {
      advance();
      if (begins_rest_) return result();
      continue;
    }
    if (asked == Ask::listen) {
      waiting_ = true;
      deadline_ns_ = now_ns + kListen_ns;
      return result();
    }
    if (asked == Ask::send_only) {
      ++part_;
    } else {
      ++tries_;
      asked_ns_ = now_ns;
      waiting_ = true;
      deadline_ns_ = now_ns + (measures_lag() ? kLagTimeout_ns : options_.answer_timeout_ns);
    }
    StepResult asking = result();
    asking.send = true;
    asking.frame = frame;
    return asking;
  }
  return result_with_keep_alive(stage_ == Stage::ready);
}

}  // namespace stilt::hal::bring_up
