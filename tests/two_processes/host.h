#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "firmware/supervisor/state.h"
#include "firmware/telemetry/secret.h"
#include "host_tools/telemetry/commander.h"
#include "host_tools/telemetry/listener.h"
#include "tests/firmware/supervisor/printers.h"
#include "tests/own_domain.h"

namespace stilt::two_processes {

/// A commander and what the robot reported last. Shows life as long as it is polled.
class Host {
 public:
  Host()
      : participant_(host_telemetry::join({.domain = tests::own_domain()})),
        listener_(participant_),
        commander_(participant_, host_telemetry::unique_name("test")) {}

  /// Polls until it holds, with a limit for hanging that is generous on a busy machine.
  [[nodiscard]] bool until(const std::function<bool()>& holds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(3);
    while (!holds()) {
      if (std::chrono::steady_clock::now() > end) return false;
      if (alive) commander_.heartbeat();
      static_cast<void>(listener_.wait(std::chrono::milliseconds(50)));
      listener_.take([this](telemetry::Sample&& sample) { take(sample); });
    }
    return true;
  }

  [[nodiscard]] bool until_state(supervisor::State wanted) {
    return until([&] { return state == wanted; });
  }

  /// The answer to a command.
  [[nodiscard]] std::string ask(telemetry::CommandKind kind, double value = 0, const std::string& key = {}) {
    const std::uint64_t number = commander_.send(kind, value, key);
    if (!until([&] { return replies.contains(number); })) return "no answer";
    return replies[number];
  }

  void learn(const std::string& token) {
    token_ = token;
    commander_.set_run(run_id, token);
  }
  [[nodiscard]] const std::string& name() const { return commander_.name(); }

  bool alive = false;
  std::uint64_t run_id = 0;
  supervisor::State state = supervisor::State::boot;
  std::string state_name;  ///< of the newest message of the supervisor
  double speed_m_s = 0;
  double ramp = 0;
  double time_s = 0;                         ///< of the robot
  std::uint64_t latched = 0;                 ///< bits of supervisor::FaultSet
  std::map<std::string, std::string> found;  ///< by name of a fault, newest
  std::uint32_t tuning = 0;
  std::array<double, 4> joint_position_rad{};
  std::vector<supervisor::State> states;
  std::map<std::uint64_t, std::string> replies;
  std::uint64_t refused = 0;  ///< commands of whomever

 private:
  /// The robot refuses a wrong token with a proof of its own.
  [[nodiscard]] bool proves_token(const telemetry::CommandReply& reply) const {
    return !reply.accepted ||
           reply.proof ==
               telemetry::proof(token_, telemetry::ReplyText{reply.run_id, reply.commander, reply.number,
                                                             reply.accepted, reply.reason, reply.time_s});
  }

  void take(const telemetry::Sample& sample) {
    if (const auto configuration = sample.as<telemetry::ActiveConfiguration>()) {
      run_id = configuration->run_id;
    } else if (const auto supervisor = sample.as<telemetry::Supervisor>()) {
      speed_m_s = supervisor->speed_m_s;
      ramp = supervisor->ramp;
      time_s = supervisor->time_s;
      state_name = supervisor->state_name;
      latched = supervisor->latched_faults;
      for (std::uint32_t i = 0; i < supervisor->found._length; ++i)
        found[supervisor->faults._buffer[i]] = supervisor->found._buffer[i];
    } else if (const auto reply = sample.as<telemetry::CommandReply>()) {
      refused += reply->accepted ? 0 : 1;
      if (reply->commander == commander_.name() && proves_token(*reply)) {
        replies[reply->number] = reply->accepted ? "accepted" : reply->reason;
      }
    } else if (const auto event = sample.as<telemetry::Event>()) {
      if (event->kind == 0) states.push_back(state = static_cast<supervisor::State>(event->state));
    } else if (const auto batch = sample.as<telemetry::TickBatch>()) {
      if (batch->count == 0) return;
      const std::size_t newest = batch->count - 1;
      tuning = batch->tuning._buffer[newest];
      std::copy_n(batch->joint_position_rad._buffer + newest * joint_position_rad.size(),
                  joint_position_rad.size(), joint_position_rad.begin());
    }
  }

  telemetry::Participant participant_;
  host_telemetry::Listener listener_;
  host_telemetry::Commander commander_;
  std::string token_;
};

}  // namespace stilt::two_processes
