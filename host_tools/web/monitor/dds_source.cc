#include "host_tools/web/monitor/dds_source.h"

#include <algorithm>
#include <array>

#include "firmware/telemetry/secret.h"
#include "firmware/telemetry/token.h"

namespace stilt::monitor {
namespace {

using telemetry::Topic;

/// The topics that a monitor shows.
constexpr std::array<const Topic*, 10> kTopics = {
    &telemetry::kConfiguration,  &telemetry::kTuning,         &telemetry::kTicks,  &telemetry::kPlannerCycles,
    &telemetry::kPlans,          &telemetry::kSupervisor,     &telemetry::kEvents, &telemetry::kTiming,
    &telemetry::kCommandReplies, &host_telemetry::kSimulation};

/// Largest number of commands without reply of one sender; its oldest is dropped, and none of another.
constexpr std::size_t kAskedAtMost = 32;

}  // namespace

DdsSource::DdsSource(const telemetry::Network& network, std::string token,
                     std::function<void(const std::string&)> warn)
    : network_(network),
      participant_(host_telemetry::join(network)),
      listener_(participant_, kTopics),
      commander_(participant_, host_telemetry::unique_name("monitor")),
      token_(std::move(token)),
      warn_(std::move(warn)) {}

std::string DdsSource::describe() const {
  return "stiltd on interface " + network_.interface + ", domain " + std::to_string(network_.domain);
}

void DdsSource::poll(SampleSink& sink) {
  if (!chosen_.empty()) {
    for (const KnownRun& run : decoder_.runs()) {
      if (run_text(run.run_id) == chosen_) decoder_.choose(run.run_id, sink);
    }
    learn_token();
    chosen_.clear();
  }
  listener_.take([&](const telemetry::Sample& message) { take(message, sink); });
}

void DdsSource::take(const telemetry::Sample& message, SampleSink& sink) {
  if (message.topic != &telemetry::kCommandReplies) {
    decoder_.take(message, sink);
    learn_token();
    return;
  }
  if (const auto reply = message.as<telemetry::CommandReply>()) answer(*reply, sink);
}

std::vector<SendingRun> DdsSource::talking() const {
  std::vector<SendingRun> all;
  for (const KnownRun& run : decoder_.runs()) {
    if (run.sends) all.push_back({run_text(run.run_id), run.robot});
  }
  return all;
}

/// Empty when it is not known: the commander must then give it.
std::string DdsSource::token_of(const KnownRun& run) const {
  if (run.run_id == decoder_.run_id() && !token_.empty()) return token_;
  return telemetry::read_token(run.token_file).value_or(token_);
}

/// Reads the token of the run that is shown, when that is another one.
void DdsSource::learn_token() {
  if (decoder_.run_id() == run_id_) return;
  run_id_ = decoder_.run_id();
  for (const KnownRun& run : decoder_.runs()) {
    if (run.run_id != run_id_) continue;
    active_token_ = token_of(run);
    if (active_token_.empty()) {
      warn_("cannot read " + run.token_file +
            ", the token of the robot; give --token-file FILE, or enter the token " +
            "under Access on the page");
    }
  }
}

/// Tokens for a stop or cut of that run, each once. What was given may be wrong, so it comes last: the robot
/// has then accepted the order.
std::vector<std::string> DdsSource::tokens_for(const KnownRun& run, const std::string& given,
                                               bool with_known) const {
  std::vector<std::string> tokens;
  const auto add = [&tokens](const std::string& token) {
    if (!token.empty() && std::ranges::find(tokens, token) == tokens.end()) tokens.push_back(token);
  };
  if (with_known) {
    if (run.run_id == run_id_) add(active_token_);  // its file may be gone
    add(token_of(run));
    add(token_);
    add(telemetry::read_token(run.token_file).value_or(""));
  }
  add(given);
  return tokens;
}

/// For the run that is shown, at least one.
std::vector<std::string> DdsSource::tokens_of(const Command& command) const {
  std::vector<std::string> tokens;
  if (command.with_known_tokens && telemetry::is_of_everybody(command.kind)) {
    for (const KnownRun& run : decoder_.runs()) {
      if (run.run_id == decoder_.run_id()) tokens = tokens_for(run, command.token, true);
    }
  }
  if (tokens.empty()) tokens.push_back(command.token.empty() ? active_token_ : command.token);
  return tokens;
}

void DdsSource::stop_others(const Command& command) {
  for (const KnownRun& run : decoder_.runs()) {
    if (run.run_id == run_id_) continue;
    const auto found = command.tokens_of_others.find(run_text(run.run_id));
    const std::string given = found == command.tokens_of_others.end() ? "" : found->second;
    for (const std::string& token : tokens_for(run, given, command.with_known_tokens)) {
      commander_.set_run(run.run_id, token);
      static_cast<void>(commander_.send(CommandKind::stop));
    }
  }
}

void DdsSource::answer(const telemetry::CommandReply& reply, SampleSink& sink) {
  if (commander_.name() != reply.commander) return;
  for (auto& [sender, commands] : asked_) {
    const auto asked = std::ranges::find(commands, reply.number, &Asked::number);
    if (asked == commands.end()) continue;
    // Every robot of the domain receives a command; those that it is not for refuse it.
    if (asked->run_id != reply.run_id) return;
    const std::string expected =
        telemetry::proof(asked->token, telemetry::ReplyText{reply.run_id, reply.commander, reply.number,
                                                            reply.accepted, reply.reason, reply.time_s});
    const bool proven = !asked->token.empty() && telemetry::same_secret(reply.proof, expected);
    // A robot with another token refuses and cannot prove ours. A forged refusal is a line on the page; the
    // robot's own reply still counts.
    if (!proven && (reply.accepted || asked->refused)) return;
    sink.reply({sender, asked->sequence, reply.accepted, reply.reason, proven});
    if (proven) {
      std::erase_if(commands, [sequence = asked->sequence](const Asked& one) {
        return one.sequence == sequence;  // also with other tokens
      });
    } else {
      asked->refused = true;
    }
    return;
  }
}

void DdsSource::send(const Command& command, const std::string& token) {
  commander_.set_run(decoder_.run_id(), token);
  const std::uint64_t number = commander_.send(command.kind, command.value, command.tunable);
  if (command.kind == CommandKind::heartbeat) return;
  std::deque<Asked>& of_sender = asked_[command.commander];
  of_sender.push_back({number, decoder_.run_id(), command.sequence, token});
  if (of_sender.size() > kAskedAtMost) of_sender.pop_front();
}

void DdsSource::command(const Command& command) {
  for (const std::string& token : tokens_of(command)) send(command, token);
  if (command.kind == CommandKind::stop) stop_others(command);
}

}  // namespace stilt::monitor
