// With any subscribers, however slow, the same walk in lock-step has the same frames on the buses, with their
// ticks. It allocates nothing in ticks and solves. In real time: toolchain/measure_telemetry.
#include <gtest/gtest.h>

#include <csignal>
#include <functional>
#include <memory>

#include "firmware/telemetry/tick_batch.h"
#include "host_tools/telemetry/listener.h"
#include "tests/own_domain.h"
#include "tests/two_processes/page_client.h"
#include "tests/two_processes/robot_and_controller.h"

namespace stilt::two_processes {
namespace {

using host_telemetry::Listener;

/// Every frame on the buses of a short walk, with its tick.
/// @param settings  of the controller
/// @param midway    called while it walks
std::string frames_of_walk(RobotAndController& run, const std::vector<std::string>& settings,
                           const std::function<void()>& midway) {
  std::vector<std::string> options = {"--lockstep", "--start", "walk@0.5", "--duration", "16"};
  options.insert(options.end(), settings.begin(), settings.end());
  run.start_robot({"--lockstep", "--once"});
  run.start_controller(options);
  EXPECT_TRUE(wait_for_text(run.file("controller.err"), "walk", kLongestRun_s)) << run.said();
  midway();
  EXPECT_FALSE(run.controller().wait(0)) << "it has ended already, so that was not midway\n" << run.said();
  run.expect_both_to_end();
  EXPECT_EQ(run.controller().wait(0), 0) << run.said();
  EXPECT_EQ(run.controller_json().at("heap_allocations"), 0);
  EXPECT_TRUE(run.controller_json().at("faults").empty()) << run.said();
  return text_of(run.file("frames"));
}

std::string frames_without_telemetry() {
  RobotAndController silent;
  std::string frames = frames_of_walk(silent, {"--set", "telemetry.enabled=false"}, [] {});
  EXPECT_GT(frames.size(), 100'000u);
  return frames;
}

std::vector<std::string> in_own_domain(std::vector<std::string> words) {
  words.insert(words.end(), {"--domain", std::to_string(tests::own_domain())});
  return words;
}

TEST(Subscribers, ten_listeners_and_some_that_never_listen_change_no_frame_on_the_buses) {
  RobotAndController subscribed;
  const std::string without = frames_without_telemetry();
  const telemetry::Participant participant = host_telemetry::join({.domain = tests::own_domain()});
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
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  const std::string with = frames_of_walk(subscribed, {}, [] {});
  listening.request_stop();
  listening.join();
  EXPECT_TRUE(with == without);
  const auto all = subscribed.controller_json().at("ticks").get<std::uint64_t>();
  for (std::size_t i = 0; i < listeners.size(); ++i) {
    EXPECT_EQ(first_tick[i], 0u) << "listener " << i;
    EXPECT_EQ(ticks[i], all) << "listener " << i;
  }
}

TEST(Subscribers,
     a_recorder_that_is_stopped_in_mid_walk_changes_no_frame_and_knows_afterwards_what_it_missed) {
  const std::string without = frames_without_telemetry();
  RobotAndController run;
  Process recorder(in_own_domain({STILT_PROGRAM, "record", "--out", run.file("walk.mcap"), "--json",
                                  run.file("record.json")}),
                   run.file("record.out"), run.file("record.err"));
  ASSERT_TRUE(wait_for_text(run.file("record.err"), "recording to", kLongestRun_s));
  const std::string with = frames_of_walk(run, {}, [&] { recorder.signal(SIGSTOP); });
  EXPECT_TRUE(with == without);
  recorder.signal(SIGCONT);
  recorder.signal(SIGINT);
  const auto status = recorder.wait(kLongestRun_s);
  ASSERT_TRUE(status);
  const auto record = nlohmann::json::parse(text_of(run.file("record.json")));
  ASSERT_EQ(record.at("runs").size(), 1u);
  const auto kept = record.at("runs").at(0).at("ticks").get<std::uint64_t>();
  EXPECT_GT(kept, 1000u) << "it had come as far as the walk";
  EXPECT_EQ(*status, record.at("complete") ? 0 : 1);
}

TEST(Subscribers, a_monitor_killed_in_mid_walk_with_a_page_open_changes_no_frame_on_the_buses) {
  const std::string without = frames_without_telemetry();
  RobotAndController run;
  Process monitor(in_own_domain({STILT_PROGRAM, "monitor", "--port", "0", "--no-browser"}),
                  run.file("monitor.out"), run.file("monitor.err"));
  PageClient page(url_of_monitor(run.file("monitor.out"), kLongestRun_s));
  const std::string with = frames_of_walk(run, {}, [&] {
    EXPECT_TRUE(page.wait_for(R"("received":true)", kLongestRun_s)) << "the page shows the robot";
    monitor.signal(SIGKILL);
    EXPECT_EQ(monitor.wait(kLongestRun_s), 128 + SIGKILL);
  });
  EXPECT_TRUE(page.wait_for_end(kLongestRun_s));
  EXPECT_TRUE(with == without);
}

}  // namespace
}  // namespace stilt::two_processes
