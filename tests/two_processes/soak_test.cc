// Walks that end in stands because the host has gone, on buses that lose, delay and repeat frames,
// with pushes. In lock-step.
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "firmware/telemetry/token.h"
#include "tests/two_processes/host.h"
#include "tests/two_processes/robot_and_controller.h"

namespace stilt::two_processes {
namespace {

using supervisor::State;
using telemetry::CommandKind;

constexpr unsigned kSeed = 1;
constexpr double kWalk_s = 4.0, kStand_s = 30.0, kHostGone_s = 10.0;

/// Faults of single ticks at random times, two per second in the mean, and every 5 s a push of at most 10 N.
std::vector<std::string> disturbances(double duration_s) {
  std::mt19937 random(kSeed);
  const auto between = [&random](double from, double to) {
    return std::uniform_real_distribution(from, to)(random);
  };
  const auto one_of = [&random](int count) { return std::uniform_int_distribution(0, count - 1)(random); };
  constexpr const char* kKinds[] = {"drop", "delay", "duplicate"};  // a CAN controller drops spoilt frames
  std::vector<std::string> options;
  for (double time_s = 1.0; time_s < duration_s; time_s += std::exponential_distribution(2.0)(random)) {
    options.push_back("--fault");
    options.push_back(std::string(kKinds[one_of(3)]) + (one_of(2) == 0 ? ":0@" : ":1@") +
                      std::to_string(time_s) + "+0.002");
  }
  for (double time_s = 5.0; time_s < duration_s; time_s += 5.0) {
    options.push_back("--push");
    options.push_back(std::to_string(between(-10.0, 10.0)) + "@" + std::to_string(time_s) +
                      (one_of(2) == 0 ? "+1@hip" : "+1@torso"));
  }
  return options;
}

class Soak : public testing::Test {
 protected:
  /// Walks and stands `rounds` times.
  void run(int rounds) {
    start(rounds * (kWalk_s + kHostGone_s + kStand_s + 10.0));
    for (int round = 0; round < rounds && !HasFatalFailure(); ++round) {
      SCOPED_TRACE("seed " + std::to_string(kSeed) + ", round " + std::to_string(round));
      walk_until_the_host_has_gone();
    }
    if (HasFatalFailure()) return;
    EXPECT_EQ(host_.latched, 0u);
    run_.end_robot();
    run_.expect_both_to_end();
    EXPECT_EQ(run_.robot_json().at("gantry"), "off") << run_.said();
    EXPECT_TRUE(run_.robot_json().at("survived")) << run_.said();
  }

 private:
  void start(double duration_s) {
    std::vector<std::string> robot = {"--lockstep", "--once",
                                      "--plant",    "encoder_noise_rad=0.0005",
                                      "--plant",    "base_pitch_noise_rad=0.001"};
    const std::vector<std::string> disturbed = disturbances(duration_s);
    robot.insert(robot.end(), disturbed.begin(), disturbed.end());
    run_.start_robot(robot);
    run_.start_controller({"--lockstep", "--start", "stand", "--set",
                           "supervisor.heartbeat_timeout_s=" + std::to_string(kHostGone_s), "--set",
                           "supervisor.operator_gone_s=600", "--set", "telemetry.release_s=60"});
    ASSERT_TRUE(host_.until([&] { return host_.run_id != 0; })) << run_.said();
    host_.learn(telemetry::read_token(run_.file("token")).value());
    host_.alive = true;
    ASSERT_TRUE(host_.until([&] { return host_.state == State::stand && host_.ramp >= 1.0; })) << run_.said();
  }

  void walk_until_the_host_has_gone() {
    host_.alive = true;
    ASSERT_EQ(host_.ask(CommandKind::walk, 0.4), "accepted");
    ASSERT_TRUE(host_.until_state(State::walk)) << run_.said();
    const double from_s = host_.time_s;
    ASSERT_TRUE(host_.until([&] { return host_.time_s > from_s + kWalk_s; }));
    host_.alive = false;
    ASSERT_TRUE(host_.until([&] { return host_.state != State::walk && host_.state != State::step; }));
    ASSERT_EQ(host_.state, State::stand) << run_.said();
    const double stood_s = host_.time_s;
    ASSERT_TRUE(
        host_.until([&] { return host_.time_s > stood_s + kStand_s || host_.state != State::stand; }));
    ASSERT_EQ(host_.state, State::stand) << run_.said();
  }

  RobotAndController run_;
  Host host_;
};

TEST_F(Soak, AWalkWhoseHostHasGoneEndsInAStandThatLasts) { run(2); }

// An hour: ctest -C long -R Soak.for_an_hour
TEST_F(Soak, DISABLED_ForAnHour) { run(80); }

}  // namespace
}  // namespace stilt::two_processes
