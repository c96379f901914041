#include "firmware/telemetry/telemetry_node.h"

#include <algorithm>
#include <cmath>

#include "firmware/robots/robots.h"

// Thread, delivery and commands of telemetry: docs/decisions/0009-telemetry.md
namespace stilt::telemetry {
namespace {

constexpr double kFlush_s = 1.0;
/// Fewer than the sender keeps (kTicks).
constexpr std::uint64_t kBatchesAhead = 100;
/// Commands that may wait, and those taken at a time. A flood of the topic, with the token or without, does
/// not displace a commander's commands before they are read. Nor does it keep this thread from its other
/// work.
constexpr int kCommandsWait = 4096;
constexpr int kCommandsAtOnce = 1024;
constexpr std::uint8_t kCommandEvent = 4;
constexpr std::uint8_t kCommanderEvent = 5;

std::uint64_t ticks_of(double period_s, double rate_hz) {
  return static_cast<std::uint64_t>(std::max(1LL, std::llround(period_s * rate_hz)));
}

std::string none_is_empty(const std::string& text) { return text == "none" ? "" : text; }

Asked asked(const Command& command) {
  return {command.run_id, command.token, command.commander, command.number,
          command.kind,   command.value, command.key};
}

std::string described(const Asked& asked) {
  const auto kind = static_cast<CommandKind>(asked.kind);
  std::string text = asked.commander + ": " + name(kind);
  if (kind == CommandKind::tunable) text += " " + asked.key;
  const bool has_value = kind == CommandKind::tunable || kind == CommandKind::walk ||
                         kind == CommandKind::speed || kind == CommandKind::height;
  return has_value ? text + " " + configuration::number_text(asked.value) : text;
}

}  // namespace

TelemetryNode::TelemetryNode(const configuration::Configuration& configuration, RunDescription run,
                             control_loop::Mailboxes& mail, const model::RobotModel& robot)
    : configuration_(configuration),
      run_(std::move(run)),
      mail_(mail),
      run_id_(random_run_id()),
      tuner_(configuration, robot, mail),
      joint_states_every_(
          ticks_of(1.0 / configuration.telemetry.joint_states_hz, configuration.timing.torque_rate_hz)),
      supervisor_every_(
          ticks_of(1.0 / configuration.telemetry.supervisor_hz, configuration.timing.torque_rate_hz)),
      second_(ticks_of(1.0, configuration.timing.torque_rate_hz)) {}

std::expected<std::unique_ptr<TelemetryNode>, std::string> TelemetryNode::open(
    const configuration::Configuration& configuration, const RunDescription& run,
    control_loop::Mailboxes& mail) {
  const auto robot = robots::find(configuration.hardware.robot);
  if (!robot) return std::unexpected("telemetry: " + robot.error());
  std::unique_ptr<TelemetryNode> node(new TelemetryNode(configuration, run, mail, (*robot)->model));
  if (const auto joined = node->join(); !joined) return std::unexpected(joined.error());
  return node;
}

std::expected<void, std::string> TelemetryNode::join() {
  const configuration::TelemetryParameters& parameters = configuration_.telemetry;
  run_.token_file = token_path(parameters.token_file, parameters.domain);
  if (!parameters.fixed_token) {
    auto held = TokenFile::hold(run_.token_file);
    if (!held) return std::unexpected(held.error());
    token_file_ = std::move(*held);
  }
  auto participant =
      Participant::open({parameters.domain, parameters.interface, none_is_empty(parameters.peers),
                         none_is_empty(parameters.security_folder)});
  if (!participant) return std::unexpected(participant.error());
  participant_ = std::make_unique<Participant>(std::move(*participant));
  auto publisher = Publisher::open(*participant_, run_id_);
  if (!publisher) return std::unexpected(publisher.error());
  publisher_ = std::make_unique<Publisher>(std::move(*publisher));
  auto ros = RosPublisher::open(*participant_);
  if (!ros) return std::unexpected(ros.error());
  ros_ = std::make_unique<RosPublisher>(std::move(*ros));
  auto commands = Reader::open(*participant_, kCommands, kCommandsWait);
  if (!commands) return std::unexpected(commands.error());
  commands_ = std::make_unique<Reader>(std::move(*commands));
  auto twists = Reader::open(*participant_, kSpeedCommands);
  if (!twists) return std::unexpected(twists.error());
  twists_ = std::make_unique<Reader>(std::move(*twists));
  return {};
}

std::expected<void, std::string> TelemetryNode::take_commands() {
  const configuration::TelemetryParameters& parameters = configuration_.telemetry;
  const auto secret = parameters.fixed_token ? read_token(run_.token_file) : token_file_.write();
  if (!secret) return std::unexpected(secret.error());
  token_ = *secret;
  const ArbiterRules rules{run_id_,
                           *secret,
                           run_.token_file,
                           parameters.speed_limit_m_s,
                           configuration_.supervisor,
                           parameters.release_s,
                           parameters.cmd_vel};
  arbiter_ = std::make_unique<CommandArbiter>(rules, [this](const std::string& key, double value) {
    std::string wrong = tuner_.set(key, value);
    if (wrong.empty()) publisher_->tuning(tuner_, key, tuned_by_);
    return wrong;
  });
  return {};
}

Drops TelemetryNode::drops() const {
  return {mail_.telemetry.dropped(), mail_.cycles.dropped(), mail_.events.dropped()};
}

RobotNow TelemetryNode::now() const {
  const auto wall = std::chrono::steady_clock::now().time_since_epoch();
  const std::int64_t wall_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(wall).count();
  return {run_.lockstep ? newest_.time_ns : wall_ns,
          wall_ns,
          newest_.state,
          newest_.present,
          newest_.latched,
          standstill_s_,
          damping_left_s()};
}

/// As the supervisor counts it.
double TelemetryNode::damping_left_s() const {
  if (!supervisor::damps(newest_.state) || newest_.level == supervisor::FallbackLevel::off) return 0.0;
  const double damped_s = 1e-9 * static_cast<double>(newest_.time_ns - damped_ns_);
  return std::max(0.0, configuration_.supervisor.damped_before_off_s - damped_s);
}

void TelemetryNode::begin(const control_loop::TickRecord& record) {
  begun_ = true;
  const auto today = std::chrono::system_clock::now().time_since_epoch();
  const std::int64_t today_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(today).count();
  // The tick began before housekeeping came to it. Virtual time does not show how long ago.
  const std::int64_t age_ns = run_.lockstep ? 0 : now().wall_ns - record.time_ns;
  time_ = {record.time_ns, today_ns - age_ns};
  publisher_->configuration(configuration_, run_, tuner_, time_);
  publisher_->tuning(tuner_, "", "");
}

void TelemetryNode::send_supervisor() {
  publisher_->supervisor(newest_, time_, {arbiter_->commander(), arbiter_->alive(now())},
                         tuner_.base_height_m(), found_);
}

/// In lock-step time waits for subscribers, as it does for the robot: a record has every tick, however fast
/// the run.
void TelemetryNode::send_batch() {
  publisher_->ticks(batch_, drops());
  batch_.clear();
  if (run_.lockstep && ++batches_ % kBatchesAhead == 0) static_cast<void>(publisher_->flush(kFlush_s));
}

void TelemetryNode::tick(const control_loop::TickRecord& record) {
  if (!begun_) begin(record);
  const bool changed = record.state != newest_.state || record.level != newest_.level ||
                       record.present != newest_.present || record.latched != newest_.latched;
  changed_ = changed_ || changed;
  if (!supervisor::damps(newest_.state)) damped_ns_ = record.time_ns;
  newest_ = record;
  if (!batch_.takes(record)) send_batch();
  batch_.add(record);
  if (batch_.size() >= static_cast<std::size_t>(configuration_.telemetry.ticks_per_batch)) send_batch();
  if (changed || record.tick % supervisor_every_ == 0) send_supervisor();
  if (record.tick % joint_states_every_ != 0) return;
  ros_->joint_states(record, time_);
  ros_->odometry(record, time_);
}

void TelemetryNode::event(const control_loop::Event& event) {
  using Kind = control_loop::Event::Kind;
  publisher_->event(event, drops());
  const bool bring_up = event.kind == Kind::bring_up_failed;
  const supervisor::Fault fault = bring_up ? supervisor::Fault::bring_up_failed : event.fault;
  if (!bring_up && (event.kind != Kind::fault || fault == supervisor::Fault::bring_up_failed)) return;
  found_[static_cast<std::size_t>(fault)] =
      bring_up ? diagnostics::bring_up_text(event.bring_up) : diagnostics::found_words(event.found);
  changed_ = true;
  if (begun_) send_supervisor();
}

void TelemetryNode::publish(const diagnostics::LoopStatistics& loop,
                            const diagnostics::PlannerStatistics& planning) {
  if (!begun_) return;
  while (const control_loop::CycleRecord* cycle = mail_.cycles.front()) {
    publisher_->cycle(*cycle, drops());
    mail_.cycles.pop();
  }
  if (mail_.previews.has_news()) publisher_->plan(mail_.previews.newest(), tuner_.settings());
  const bool due = newest_.tick >= statistics_due_;
  if (due) {
    statistics_due_ = newest_.tick + second_;
    publisher_->timing(loop, planning, configuration_, time_.seconds(newest_.time_ns), drops());
  }
  if (due || changed_)
    ros_->diagnostics(newest_, loop, planning, time_, configuration_.hardware.robot, found_);
  changed_ = false;
}

void TelemetryNode::answer(const Command& command) {
  const Asked what = asked(command);
  tuned_by_ = what.commander;
  const Answer answer = arbiter_->take(what, now());
  const double time_s = time_.seconds(newest_.time_ns);
  if (!answer.silent) {
    publisher_->reply(token_, what.commander, what.number, answer.accepted, answer.reason, time_s);
  }
  if (answer.accepted && !answer.silent) {
    publisher_->note(kCommandEvent, time_s, name(static_cast<CommandKind>(what.kind)), described(what),
                     drops());
  }
}

void TelemetryNode::watch_commander() {
  if (arbiter_->commander() == commander_) return;
  commander_ = arbiter_->commander();
  publisher_->note(kCommanderEvent, time_.seconds(newest_.time_ns), "commander",
                   commander_.empty() ? "no commander" : commander_ + " commands", drops());
}

control_loop::OperatorCommand TelemetryNode::operate(const control_loop::OperatorCommand& script) {
  if (operated_wall_ns_ != 0 && !run_.lockstep)
    standstill_s_ = 1e-9 * static_cast<double>(now().wall_ns - operated_wall_ns_);
  commands_->take(
      [this](Sample&& sample) {
        if (const auto command = sample.as<Command>()) answer(*command);
      },
      kCommandsAtOnce);
  twists_->take(
      [this](Sample&& sample) {
        if (const auto twist = sample.as<Twist>()) arbiter_->twist(twist->linear.x, now());
      },
      kCommandsAtOnce);
  const control_loop::OperatorCommand command = arbiter_->command(script, now());
  watch_commander();
  operated_wall_ns_ = now().wall_ns;
  return command;
}

void TelemetryNode::flush() {
  if (batch_.size() > 0) send_batch();
  if (begun_) send_supervisor();
  static_cast<void>(publisher_->flush(kFlush_s));
}

}  // namespace stilt::telemetry
