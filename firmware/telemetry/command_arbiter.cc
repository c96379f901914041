#include "firmware/telemetry/command_arbiter.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "firmware/telemetry/secret.h"

namespace stilt::telemetry {
namespace {

using supervisor::RequestKind;
using supervisor::State;

constexpr std::size_t kLongestName = 64;
constexpr std::size_t kMostCommanders = 256;
constexpr std::size_t kMostLatecomers = 64;
/// Refusals of those without the token: one in this time is answered.
constexpr std::int64_t kRejectionsApart_ns = 50'000'000;

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

double tenths(double value) noexcept { return 1e-1 * std::round(1e1 * value); }

bool stands_or_moves(State state) noexcept { return supervisor::tracks(state); }

/// Names of the faults of a set whose reset it takes, separated by commas; empty: there are none.
std::string latching(const supervisor::FaultSet& set) {
  std::string names;
  for (const supervisor::FaultRow& fault : supervisor::kFaultTable) {
    if (fault.severity != supervisor::Severity::latched || !set.has(fault.fault)) continue;
    names += (names.empty() ? "" : ", ") + std::string(fault.name);
  }
  return names;
}

std::string in_state(State state) { return std::string("the robot is in state ") + supervisor::name(state); }

}  // namespace

std::string wrong_state(CommandKind kind, State state) {
  const std::string now = in_state(state);
  switch (kind) {
    case CommandKind::prepare:
      return state == State::idle ? "" : now + "; drivers are brought up from idle";
    case CommandKind::stand:
      return state == State::idle || state == State::calibrate || state == State::ready ||
                     stands_or_moves(state)
                 ? ""
                 : now + "; it can stand up from idle or ready" +
                       (state == State::fault ? ", after a reset" : "");
    case CommandKind::step:
    case CommandKind::walk:
      return stands_or_moves(state) ? "" : now + "; it steps and walks from stand";
    case CommandKind::speed:
      return state == State::walk ? "" : now + "; a speed belongs to a walk";
    case CommandKind::sit:
      return stands_or_moves(state) ? "" : now + "; it sits down from stand";
    case CommandKind::reset:
      return state == State::fault ? "" : now + "; there is nothing to reset";
    case CommandKind::height:
    case CommandKind::tunable:
      return state == State::off || state == State::watch ? now + "; no value changes there" : "";
    default:
      return state == State::off ? now : "";
  }
}

double CommandArbiter::silence_s(const RobotNow& now) const noexcept {
  return 1e-9 * static_cast<double>(now.wall_ns - heartbeat_wall_ns_);
}

bool CommandArbiter::alive(const RobotNow& now) const noexcept {
  return !commander_.empty() && silence_s(now) <= rules_.supervisor.heartbeat_timeout_s;
}

/// After a cut nothing else is asked for, also when both came before the torque loop took the first.
void CommandArbiter::ask(RequestKind kind, double speed_m_s) noexcept {
  twist_ = {};
  if (request_.kind == RequestKind::cut) return;
  request_ = {kind, request_.number + 1, speed_m_s};
}

/// Standing still is asked for where the robot is on its feet; elsewhere nothing is.
void CommandArbiter::stop(const RobotNow& now) noexcept {
  standing_up_ = false;
  script_ended_ = true;
  ask(stands_or_moves(now.state) ? RequestKind::stand : RequestKind::none);
}

bool CommandArbiter::waits_to_stand(State state) const noexcept {
  return standing_up_ || (state == State::ready && request_.kind == RequestKind::stand);
}

/// What a stop drops that was asked for and has not begun; empty: nothing.
std::string CommandArbiter::dropped_by_stop(State state) const {
  if (waits_to_stand(state)) return "stand";
  if (state == State::fault && request_.kind == RequestKind::reset) return "reset";
  const bool sits = state == State::sit || supervisor::damps(state);
  if (sits && request_.kind == RequestKind::off) return "switch off";
  return {};
}

/// What an accepted command does not do now; empty: it does all. Before the command is applied.
std::string CommandArbiter::caveat(CommandKind kind, const RobotNow& now) const {
  if (kind == CommandKind::stop && !stands_or_moves(now.state)) {
    const std::string dropped = dropped_by_stop(now.state);
    if (dropped.empty()) return in_state(now.state) + ", where stop changes nothing";
    return in_state(now.state) + ", and the request to " + dropped + " is dropped";
  }
  if (kind != CommandKind::reset && kind != CommandKind::off) return {};
  const double left_s = tenths(now.damping_left_s);
  const std::string causes =
      kind == CommandKind::reset ? latching(now.present - supervisor::kEndedByBringUp) : "";
  if (!causes.empty()) {
    return causes + " is still there: this reset ends after " +
           number_text(left_s + rules_.supervisor.reset_window_s) + " s; reset again when that is over";
  }
  return left_s > 0 ? "the joints are damped for " + number_text(left_s) + " s first" : "";
}

/// Whether the sender gave the token or proved to have it. Texts that no commander sends cost no time.
bool CommandArbiter::has_token(const Asked& asked) const {
  if (rules_.token.empty()) return false;
  if (same_secret(asked.token, rules_.token)) return true;
  if (std::max(asked.commander.size(), asked.key.size()) > kLongestName) return false;
  return same_secret(asked.token, proof(rules_.token, {asked.run_id, asked.commander, asked.number,
                                                       asked.kind, asked.value, asked.key}));
}

/// Why a sender is refused; empty: it has the token, and this is not a repetition of what one has sent.
std::string CommandArbiter::rejection(const Asked& asked) const {
  if (asked.run_id != rules_.run_id) {
    return "the command is for another run of stiltd; take run_id from the configuration topic";
  }
  if (!has_token(asked)) {
    return "the token is wrong; it is the first line of " + rules_.token_file + " on the robot";
  }
  const std::uint64_t* last = last_number(asked.commander);
  if (last != nullptr && asked.number <= *last) {
    return "command " + std::to_string(asked.number) + " came after " + std::to_string(*last) +
           ": it is late, or was sent twice";
  }
  return {};
}

const std::uint64_t* CommandArbiter::last_number(const std::string& commander) const {
  if (const auto found = numbers_.find(commander); found != numbers_.end()) return &found->second;
  const auto late = std::ranges::find(latecomers_, commander, &Latecomer::first);
  return late == latecomers_.end() ? nullptr : &late->second;
}

void CommandArbiter::remember(const std::string& commander, std::uint64_t number) {
  if (numbers_.contains(commander) || numbers_.size() < kMostCommanders) {
    numbers_[commander] = number;
    return;
  }
  std::erase_if(latecomers_, [&](const Latecomer& late) { return late.first == commander; });
  latecomers_.emplace_back(commander, number);
  if (latecomers_.size() > kMostLatecomers) latecomers_.pop_front();
}

Answer CommandArbiter::reject(std::string reason, const RobotNow& now) noexcept {
  const bool silent = rejected_ && now.wall_ns - rejected_wall_ns_ < kRejectionsApart_ns;
  if (!silent) rejected_wall_ns_ = now.wall_ns;
  rejected_ = true;
  return {false, silent, std::move(reason)};
}

std::string CommandArbiter::refusal(const Asked& asked, const RobotNow& now) {
  if (asked.commander.empty() || asked.commander.size() > kLongestName) {
    return "a commander needs a name of 1 to 64 characters";
  }
  if (asked.kind >= kCommandKinds) {
    return "there is no kind of command " + std::to_string(asked.kind) + "; they are 0 to " +
           std::to_string(kCommandKinds - 1);
  }
  const auto kind = static_cast<CommandKind>(asked.kind);
  const bool is_new = !numbers_.contains(asked.commander) && !is_of_everybody(kind);
  if (is_new && numbers_.size() >= kMostCommanders) {
    return "there were too many commanders in this run; start stiltd again, or use a name a second time";
  }
  remember(asked.commander, asked.number);
  return is_order(kind) ? refusal_of_order(asked, kind, now) : "";
}

std::string CommandArbiter::refusal_of_order(const Asked& asked, CommandKind kind,
                                             const RobotNow& now) const {
  if (request_.kind == RequestKind::cut || ending_) return "stiltd is ending, and takes no more orders";
  if (commander_ != asked.commander && alive(now)) {
    return commander_ + " commands the robot; it must release it or fall silent first";
  }
  if (now.standstill_s > rules_.supervisor.heartbeat_timeout_s) {
    return "stiltd stood still for " + number_text(tenths(now.standstill_s)) +
           " s while this order came: look, then order again";
  }
  if (!std::isfinite(asked.value)) return std::string(name(kind)) + ": the value is not a number";
  const bool has_speed = kind == CommandKind::walk || kind == CommandKind::speed;
  if (has_speed && std::abs(asked.value) > rules_.speed_limit_m_s) {
    return std::string(name(kind)) + " " + number_text(asked.value) +
           " m/s is beyond telemetry.speed_limit_m_s, " + number_text(rules_.speed_limit_m_s) +
           " m/s either way";
  }
  const bool steps = kind == CommandKind::step || kind == CommandKind::walk;
  if (steps && !supervisor::may_walk(rules_.supervisor)) {
    return std::string(name(kind)) + " needs " + supervisor::key_against_walk(rules_.supervisor) +
           " of at least " + number_text(rules_.supervisor.walk_torque_share) +
           " (supervisor.walk_torque_share), and it is " +
           number_text(supervisor::torque_share_of_walk(rules_.supervisor));
  }
  if (steps && stands_or_moves(now.state) && !now.latched.empty()) {
    return latching(now.latched) + ": the robot is about to sit down; reset it then";
  }
  return wrong_state(kind, now.state);
}

std::string CommandArbiter::apply(const Asked& asked, CommandKind kind, const RobotNow& now) {
  switch (kind) {
    case CommandKind::heartbeat:
      return {};
    case CommandKind::stop:
      stop(now);
      return {};
    case CommandKind::cut:
      standing_up_ = false;
      script_ended_ = true;
      ask(RequestKind::cut);
      return {};
    case CommandKind::release:
      if (commander_ != asked.commander) return asked.commander + " is not in command";
      if (request_.kind == RequestKind::step || request_.kind == RequestKind::walk) stop(now);
      commander_.clear();
      return {};
    case CommandKind::height:
      return set_tunable_("reference.base_height_m", asked.value);
    case CommandKind::tunable:
      return set_tunable_(asked.key, asked.value);
    case CommandKind::speed:
      twist_ = {};
      request_.speed_m_s = asked.value;
      return {};
    case CommandKind::prepare:
      ask(RequestKind::calibrate);
      return {};
    case CommandKind::stand:
      standing_up_ = now.state == State::idle || now.state == State::calibrate;
      ask(standing_up_ ? RequestKind::calibrate : RequestKind::stand);
      return {};
    case CommandKind::step:
      ask(RequestKind::step);
      return {};
    case CommandKind::walk:
      ask(RequestKind::walk, asked.value);
      return {};
    case CommandKind::sit:
      ask(RequestKind::sit);
      return {};
    case CommandKind::reset:
      ask(RequestKind::reset);
      return {};
    case CommandKind::off:
      ask(RequestKind::off);
      return {};
  }
  return {};
}

Answer CommandArbiter::take(const Asked& asked, const RobotNow& now) {
  std::string reason = rejection(asked);
  if (!reason.empty()) return reject(std::move(reason), now);
  reason = refusal(asked, now);
  if (!reason.empty()) return {false, false, std::move(reason)};
  const auto kind = static_cast<CommandKind>(asked.kind);
  std::string note = caveat(kind, now);
  if (makes_commander(kind)) {
    if (kind != CommandKind::stand) standing_up_ = false;
    commander_ = asked.commander;
    script_ended_ = true;
  } else if (commander_.empty() && asked.commander == lost_commander_) {
    commander_ = asked.commander;  // is back
  }
  if (!commander_.empty()) lost_commander_.clear();
  if (asked.commander == commander_) heartbeat_wall_ns_ = now.wall_ns;
  reason = apply(asked, kind, now);
  if (!reason.empty()) return {false, false, std::move(reason)};
  return {true, kind == CommandKind::heartbeat, std::move(note)};
}

void CommandArbiter::twist(double speed_m_s, const RobotNow& now) {
  const bool allowed = rules_.cmd_vel && alive(now) && now.state == State::walk;
  if (allowed && std::abs(speed_m_s) <= rules_.speed_limit_m_s) twist_ = {true, speed_m_s, now.wall_ns};
}

/// That of the newest Twist, until Twists were silent for heartbeat_timeout_s or an order came after it.
double CommandArbiter::asked_speed_m_s(const RobotNow& now) const noexcept {
  const double age_s = 1e-9 * static_cast<double>(now.wall_ns - twist_.wall_ns);
  const bool counts = twist_.came && age_s <= rules_.supervisor.heartbeat_timeout_s;
  return counts ? twist_.speed_m_s : request_.speed_m_s;
}

control_loop::OperatorCommand CommandArbiter::command(const control_loop::OperatorCommand& script,
                                                      const RobotNow& now) {
  ending_ = script.shut_down;
  if (!script_ended_) {
    request_ = script.request;
    return script;
  }
  if (!commander_.empty() && silence_s(now) > rules_.release_s) {
    if (!supervisor::leads_to_rest(request_.kind)) stop(now);
    lost_commander_ = std::exchange(commander_, {});
  }
  if (waits_to_stand(now.state) && !alive(now)) {
    stop(now);
  } else if (standing_up_ && now.state == State::ready) {
    standing_up_ = false;
    ask(RequestKind::stand);
  }
  control_loop::OperatorCommand command = script;  // the end of the program is its business
  command.request = request_;
  command.request.speed_m_s = asked_speed_m_s(now);
  command.heartbeat_expected = !commander_.empty() || !lost_commander_.empty();
  command.heartbeat_ns = now.clock_ns - (now.wall_ns - heartbeat_wall_ns_);
  return command;
}

}  // namespace stilt::telemetry
