// Robot and controller in lock-step, commanded over DDS.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <thread>

#include "firmware/telemetry/token.h"
#include "tests/two_processes/host.h"
#include "tests/two_processes/page_client.h"
#include "tests/two_processes/robot_and_controller.h"

namespace stilt::two_processes {
namespace {

using supervisor::State;
using telemetry::CommandKind;

void start(RobotAndController& run, Host& host, const std::vector<std::string>& options) {
  std::vector<std::string> all = {"--lockstep", "--set", "supervisor.heartbeat_timeout_s=4", "--set",
                                  "telemetry.release_s=30"};
  all.insert(all.end(), options.begin(), options.end());
  run.start_robot({"--lockstep", "--once"});
  run.start_controller(all);
  ASSERT_TRUE(host.until([&] { return host.run_id != 0; })) << run.said();
  host.learn(telemetry::read_token(run.file("token")).value());
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
  host.learn(telemetry::read_token(run.file("token")).value());
  EXPECT_EQ(host.ask(CommandKind::stop), "accepted");
  ASSERT_TRUE(host.until_state(State::stand)) << run.said();
  run.controller().signal(SIGTERM);
  run.expect_both_to_end();
}

/// A page with the token of this user's own file, in a monitor that then is killed.
TEST(Telemetry, a_robot_walked_from_a_page_comes_to_a_stand_without_a_fault_when_the_monitor_is_killed) {
  RobotAndController run;
  Host host;
  start(run, host, {"--start", "stand"});
  if (HasFatalFailure()) return;
  ASSERT_TRUE(host.until([&] { return host.state == State::stand && host.ramp >= 1.0; })) << run.said();
  Process monitor({STILT_PROGRAM, "monitor", "--port", "0", "--no-browser", "--domain",
                   std::to_string(tests::own_domain())},
                  run.file("monitor.out"), run.file("monitor.err"));
  PageClient page(url_of_monitor(run.file("monitor.out"), kLongestRun_s));
  ASSERT_TRUE(page.wait_for(R"("received":true)", kLongestRun_s));
  std::jthread alive([&](const std::stop_token& end) {
    while (!end.stop_requested()) {
      page.send(R"({"alive": true})");
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  });
  page.send(R"({"command": "walk", "sequence": 1, "value": 0.3})");
  ASSERT_TRUE(page.wait_for(R"("sequence":1,"accepted":true)", kLongestRun_s)) << run.said();
  ASSERT_TRUE(host.until_state(State::walk)) << run.said();
  alive.request_stop();
  alive.join();
  host.states.clear();
  monitor.signal(SIGKILL);
  ASSERT_EQ(monitor.wait(kLongestRun_s), 128 + SIGKILL);
  ASSERT_TRUE(host.until_state(State::stand)) << run.said();
  EXPECT_EQ(host.states, (std::vector{State::step, State::stand}));
  run.controller().signal(SIGTERM);
  run.expect_both_to_end();
  const nlohmann::json controller = run.controller_json();
  for (const nlohmann::json& fault : controller.at("faults")) {
    EXPECT_EQ(fault.at("name"), "heartbeat_lost");
  }
}

TEST(Telemetry, a_watch_is_on_the_page_which_cannot_make_it_stand_and_whose_motors_off_ends_it) {
  RobotAndController run;
  run.start_robot({"--lockstep", "--once", "--hang"});
  run.start_command({"watch"}, {"--lockstep"});
  Process monitor({STILT_PROGRAM, "monitor", "--port", "0", "--no-browser", "--domain",
                   std::to_string(tests::own_domain())},
                  run.file("monitor.out"), run.file("monitor.err"));
  PageClient page(url_of_monitor(run.file("monitor.out"), kLongestRun_s));
  ASSERT_TRUE(page.wait_for(R"("received":true)", kLongestRun_s)) << run.said();
  const std::string state = R"("state":)" + std::to_string(static_cast<int>(State::watch)) + ',';
  EXPECT_TRUE(page.wait_for(state, kLongestRun_s)) << run.said();
  EXPECT_TRUE(page.wait_for(R"("emergency_stop":"released")", kLongestRun_s)) << run.said();
  ASSERT_TRUE(page.wait_for(R"("has_token":true)", kLongestRun_s)) << run.said();
  page.send(R"({"command": "stand", "sequence": 1})");
  EXPECT_TRUE(
      page.wait_for(R"("sequence":1,"accepted":false,"reason":"the robot is in state watch)", kLongestRun_s))
      << run.said();
  page.send(R"({"command": "cut", "sequence": 2})");
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 0) << run.said();
}

/// The walk of docs/security.md: a robot, a laptop of its authority, one of another, and one without
/// documents.
class Secured : public testing::Test {
 protected:
  Secured() {
    make("ours", {"robot:stilt", "host:laptop"});
    make("theirs", {"host:intruder"});
  }

  [[nodiscard]] std::string documents(const std::string& name) const { return run.file(name); }

  /// Starts a recorder.
  std::unique_ptr<Process> record(const std::string& name, const std::vector<std::string>& options) {
    std::vector<std::string> words = {STILT_PROGRAM, "record",
                                      "--out",       run.file(name + ".mcap"),
                                      "--json",      run.file(name + ".json"),
                                      "--domain",    std::to_string(tests::own_domain())};
    words.insert(words.end(), options.begin(), options.end());
    return std::make_unique<Process>(words, run.file(name + ".out"), run.file(name + ".err"));
  }

  /// Waits until a record holds some seconds of ticks: far more than what every record begins with.
  [[nodiscard]] bool wait_for_ticks(const std::string& name) const {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kLongestRun_s);
    std::error_code not_there_yet;
    while (std::chrono::steady_clock::now() < end) {
      const auto size = std::filesystem::file_size(run.file(name + ".mcap"), not_there_yet);
      if (!not_there_yet && size > 200'000) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
  }

  /// Ends a recorder. Messages in its record.
  [[nodiscard]] int messages(const std::string& name, Process& recorder) const {
    recorder.signal(SIGINT);
    EXPECT_TRUE(recorder.wait(kLongestRun_s)) << name;
    return nlohmann::json::parse(text_of(run.file(name + ".json"))).at("messages");
  }

  RobotAndController run;

 private:
  void make(const std::string& authority, std::vector<std::string> members) const {
    members.insert(members.begin(), {MAKE_SECURITY, run.file(authority)});
    Process made(members, run.file(authority + ".out"), run.file(authority + ".err"));
    if (made.wait(kLongestRun_s) != 0) throw std::runtime_error(text_of(run.file(authority + ".err")));
  }
};

TEST_F(Secured, a_monitor_with_documents_commands_and_a_recorder_without_them_receives_nothing) {
  run.start_robot({"--lockstep", "--once"});
  run.start_controller({"--lockstep", "--start", "stand", "--set", "supervisor.heartbeat_timeout_s=30",
                        "--set", "supervisor.operator_gone_s=60", "--set",
                        "telemetry.security_folder=" + documents("ours/stilt")});
  Process monitor({STILT_PROGRAM, "monitor", "--port", "0", "--no-browser", "--domain",
                   std::to_string(tests::own_domain()), "--security-folder", documents("ours/laptop")},
                  run.file("monitor.out"), run.file("monitor.err"));
  PageClient page(url_of_monitor(run.file("monitor.out"), kLongestRun_s));
  ASSERT_TRUE(page.wait_for(R"("received":true)", kLongestRun_s)) << run.said();
  const auto intruder = record("intruder", {"--security-folder", documents("theirs/intruder")});
  const auto undocumented = record("undocumented", {});
  const auto laptop = record("laptop", {"--security-folder", documents("ours/laptop")});
  page.send(R"({"command": "speed", "sequence": 1, "value": 9})");
  EXPECT_TRUE(page.wait_for("beyond telemetry.speed_limit_m_s", kLongestRun_s)) << "the robot received it";
  page.send(R"({"command": "height", "sequence": 2, "value": 0.76})");
  EXPECT_TRUE(page.wait_for(R"("sequence":2,"accepted":true)", kLongestRun_s)) << "and applies it";
  EXPECT_TRUE(wait_for_ticks("laptop")) << text_of(run.file("laptop.err"));
  EXPECT_GT(messages("laptop", *laptop), 0);
  EXPECT_EQ(messages("intruder", *intruder), 0);
  EXPECT_EQ(messages("undocumented", *undocumented), 0);
  run.controller().signal(SIGTERM);
  run.expect_both_to_end();
}

/// A client without the token, as fast as it can, in its own name and in the commander's.
TEST(Telemetry, a_flood_of_commands_without_the_token_neither_holds_up_the_commander_nor_moves_the_robot) {
  RobotAndController run;
  Host host;
  start(run, host, {"--start", "stand"});
  if (HasFatalFailure()) return;
  host.alive = true;
  ASSERT_TRUE(host.until([&] { return host.state == State::stand && host.ramp >= 1.0; })) << run.said();
  const auto start_time = std::chrono::steady_clock::now();
  Process flood({COMMAND_FLOOD, "--domain", std::to_string(tests::own_domain()), "--name", host.name()},
                run.file("flood.out"), run.file("flood.err"));
  ASSERT_TRUE(wait_for_text(run.file("flood.out"), "flooding", kLongestRun_s));
  ASSERT_EQ(host.ask(CommandKind::walk, 0.3), "accepted") << run.said();
  ASSERT_TRUE(host.until_state(State::walk)) << run.said();
  host.states.clear();
  const double from_s = host.time_s;
  ASSERT_TRUE(host.until([&] { return host.time_s > from_s + 5.0; })) << "walks on under the flood";
  EXPECT_EQ(host.ask(CommandKind::speed, 0.4), "accepted") << run.said();
  EXPECT_TRUE(host.until([&] { return host.speed_m_s == 0.4; }));
  EXPECT_TRUE(host.states.empty())
      << "no command of the flood is accepted, and no heartbeat of the commander is lost";
  flood.signal(SIGTERM);
  EXPECT_EQ(flood.wait(kLongestRun_s), 0);
  const auto sent = nlohmann::json::parse(text_of(run.file("flood.err"))).at("sent").get<std::uint64_t>();
  EXPECT_GT(sent, 10'000u);
  const double elapsed_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start_time).count();
  EXPECT_LE(static_cast<double>(host.refused), 20.0 * elapsed_s + 2.0)
      << "a flood is not answered with another: twenty refusals per second at most";
  run.controller().signal(SIGTERM);
  run.expect_both_to_end();
  EXPECT_EQ(run.controller_json().at("heap_allocations"), 0);
}

}  // namespace
}  // namespace stilt::two_processes
