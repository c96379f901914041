// Robot and controller in lock-step while others listen and command over DDS, each test in a domain of its
// own.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <functional>
#include <map>
#include <thread>

#include "firmware/supervisor/state.h"
#include "firmware/telemetry/tick_batch.h"
#include "host_tools/telemetry/commander.h"
#include "host_tools/telemetry/listener.h"
#include "tests/two_processes/robot_and_controller.h"

namespace stilt::two_processes {
namespace {

using namespace std::chrono_literals;
using host_telemetry::Commander;
using host_telemetry::Listener;
using supervisor::State;
using telemetry::CommandKind;

/// Beyond domain 100 ports may be taken already.
int domain() { return 5 + static_cast<int>(getpid() % 90); }

std::vector<std::string> in_domain(std::vector<std::string> options, const RobotAndController& run) {
  options.insert(options.end(), {"--set", "telemetry.domain=" + std::to_string(domain()), "--set",
                                 "telemetry.token_file=" + run.file("token")});
  return options;
}

/// A commander and what the robot said last. Shows life as long as it is polled.
class Host {
 public:
  Host()
      : participant_(host_telemetry::join({.domain = domain()})),
        listener_(participant_),
        commander_(participant_, host_telemetry::unique_name("test")) {}

  /// Polls until it holds, with a limit for hanging that is generous on a busy machine.
  [[nodiscard]] bool until(const std::function<bool()>& holds) {
    const auto end = std::chrono::steady_clock::now() + 180s;
    while (!holds()) {
      if (std::chrono::steady_clock::now() > end) return false;
      if (alive) commander_.heartbeat();
      static_cast<void>(listener_.wait(50ms));
      listener_.take([this](telemetry::Sample&& sample) { take(sample); });
    }
    return true;
  }

  [[nodiscard]] bool until_state(State wanted) {
    return until([&] { return state == wanted; });
  }

  /// The answer to a command.
  [[nodiscard]] std::string ask(CommandKind kind, double value = 0, const std::string& key = {}) {
    const std::uint64_t number = commander_.send(kind, value, key);
    if (!until([&] { return replies.contains(number); })) return "no answer";
    return replies[number];
  }

  void learn(const std::string& token) { commander_.set_session(session, token); }

  bool alive = false;
  std::uint64_t session = 0;
  State state = State::boot;
  double speed_m_s = 0;
  double ramp = 0;
  std::uint32_t tuning = 0;
  double kp_Nm_rad = 0;
  std::vector<State> states;
  std::map<std::uint64_t, std::string> replies;

 private:
  void take(const telemetry::Sample& sample) {
    if (const auto configuration = sample.as<telemetry::ConfigurationInForce>()) {
      session = configuration->session;
    } else if (const auto supervisor = sample.as<telemetry::Supervisor>()) {
      speed_m_s = supervisor->speed_m_s;
      ramp = supervisor->ramp;
    } else if (const auto reply = sample.as<telemetry::CommandReply>()) {
      if (reply->commander == commander_.name()) {
        replies[reply->number] = reply->accepted ? "accepted" : reply->reason;
      }
    } else if (const auto event = sample.as<telemetry::Event>()) {
      if (event->kind == 0) states.push_back(state = static_cast<State>(event->state));
    } else if (const auto batch = sample.as<telemetry::TickBatch>()) {
      if (batch->count > 0) tuning = batch->tuning._buffer[batch->count - 1];
    }
  }

  telemetry::Participant participant_;
  Listener listener_;
  Commander commander_;
};

void start(RobotAndController& run, Host& host, const std::vector<std::string>& options) {
  std::vector<std::string> all = {"--lockstep", "--set", "supervisor.heartbeat_timeout_s=4", "--set",
                                  "telemetry.release_s=30"};
  all.insert(all.end(), options.begin(), options.end());
  run.start_robot({"--lockstep", "--once"});
  run.start_controller(in_domain(all, run));
  ASSERT_TRUE(host.until([&] { return host.session != 0; })) << run.said();
  host.learn(host_telemetry::read_token(run.file("token")));
}

TEST(Telemetry, a_commander_stands_the_robot_up_walks_it_and_its_silence_brings_it_to_a_stand) {
  RobotAndController run;
  Host host;
  start(run, host, {});
  if (HasFatalFailure()) return;
  host.alive = true;
  ASSERT_TRUE(host.until_state(State::idle)) << run.said();
  EXPECT_NE(host.ask(CommandKind::walk, 0.3).find("state idle"), std::string::npos);
  EXPECT_EQ(host.ask(CommandKind::stand), "accepted");
  ASSERT_TRUE(host.until_state(State::stand)) << run.said();
  ASSERT_TRUE(host.until([&] { return host.ramp >= 1.0; })) << run.said();
  EXPECT_EQ(host.ask(CommandKind::walk, 0.3), "accepted");
  ASSERT_TRUE(host.until_state(State::walk)) << run.said();
  EXPECT_EQ(host.ask(CommandKind::speed, 0.4), "accepted");
  EXPECT_TRUE(host.until([&] { return host.speed_m_s == 0.4; }));
  EXPECT_NE(host.ask(CommandKind::speed, 4.0).find("beyond telemetry.speed_limit_m_s"), std::string::npos);
  EXPECT_EQ(host.ask(CommandKind::tunable, 120, "torque_law.joint_kp_Nm_rad"), "accepted");
  EXPECT_TRUE(host.until([&] { return host.tuning == 1; }));
  EXPECT_EQ(host.ask(CommandKind::height, 0.76), "accepted");
  EXPECT_TRUE(host.until([&] { return host.tuning == 2; }));
  host.states.clear();
  host.alive = false;
  ASSERT_TRUE(host.until_state(State::stand)) << run.said();
  EXPECT_EQ(host.states, (std::vector{State::step, State::stand}));
  run.controller().signal(SIGTERM);
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 0) << run.said();
}

TEST(Telemetry, a_wrong_token_is_refused_in_words_and_everybody_with_the_token_may_stop) {
  RobotAndController run;
  Host host;
  start(run, host, {"--start", "walk@0.3"});
  if (HasFatalFailure()) return;
  ASSERT_TRUE(host.until_state(State::walk)) << run.said();
  host.learn("guess");
  EXPECT_NE(host.ask(CommandKind::stop).find("the token is wrong"), std::string::npos);
  EXPECT_EQ(host.state, State::walk);
  host.learn(host_telemetry::read_token(run.file("token")));
  EXPECT_EQ(host.ask(CommandKind::stop), "accepted");
  ASSERT_TRUE(host.until_state(State::stand)) << run.said();
  run.controller().signal(SIGTERM);
  run.expect_both_to_end();
}

/// Every frame on the buses of a short walk, with its tick.
std::string frames_of_walk(RobotAndController& run, const std::vector<std::string>& settings) {
  std::vector<std::string> options = {"--lockstep", "--start", "walk@0.5", "--duration", "8"};
  options.insert(options.end(), settings.begin(), settings.end());
  run.start_robot({"--lockstep", "--once"});
  run.start_controller(in_domain(options, run));
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 0) << run.said();
  EXPECT_EQ(run.controller_json().at("heap_allocations"), 0);
  return text_of(run.file("frames"));
}

TEST(Telemetry, ten_listeners_and_some_that_never_listen_change_no_frame_on_the_buses) {
  RobotAndController silent, heard;
  const std::string without = frames_of_walk(silent, {"--set", "telemetry.enabled=false"});
  ASSERT_GT(without.size(), 100'000u);

  const telemetry::Participant participant = host_telemetry::join({.domain = domain()});
  std::vector<std::unique_ptr<Listener>> listeners;
  for (int i = 0; i < 10; ++i) listeners.push_back(std::make_unique<Listener>(participant));
  const Listener never_taken(participant);
  std::vector<std::uint64_t> first_tick(listeners.size(), 1), ticks(listeners.size());
  std::jthread listening([&](const std::stop_token& end) {
    while (!end.stop_requested()) {
      for (std::size_t i = 0; i < listeners.size(); ++i) {
        listeners[i]->take([&](telemetry::Sample&& sample) {
          const auto batch = sample.as<telemetry::TickBatch>();
          if (batch == nullptr) return;
          if (ticks[i] == 0) first_tick[i] = batch->first_tick;
          ticks[i] += batch->count;
        });
      }
      std::this_thread::sleep_for(1ms);
    }
  });
  const std::string with = frames_of_walk(heard, {});
  listening.request_stop();
  listening.join();
  EXPECT_TRUE(with == without);
  const auto all = heard.controller_json().at("ticks").get<std::uint64_t>();
  for (std::size_t i = 0; i < listeners.size(); ++i) {
    EXPECT_EQ(first_tick[i], 0u) << "listener " << i;
    EXPECT_EQ(ticks[i], all) << "listener " << i;
  }
}

}  // namespace
}  // namespace stilt::two_processes
