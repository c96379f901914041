#include <gtest/gtest.h>

#include <cstdint>
#include <memory>

#include "firmware/program/controller_state.h"

// What housekeeping commands without telemetry.
namespace stilt::program {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

struct Operate : testing::Test {
  Operate() { state->script.emplace(gait::GaitCommand{gait::GaitKind::walk, 0.5}, 1.0, 0.0); }

  control_loop::OperatorCommand after_a_tick_at(std::int64_t time_ns, std::uint64_t number = 0) {
    control_loop::TickRecord tick;
    tick.tick = number;
    tick.time_ns = time_ns;
    tick.state = supervisor::State::idle;
    state->mail.telemetry.push(tick);
    operate(*state);
    return state->mail.commands.newest();
  }

  std::unique_ptr<ControllerState> state = std::make_unique<ControllerState>();
};

TEST_F(Operate, TheHeartbeatIsThatOfHousekeepingWithASecondToSpare) {
  for (const std::int64_t time_ns : {kSecond_ns, 5 * kSecond_ns}) {
    const control_loop::OperatorCommand command = after_a_tick_at(time_ns);
    EXPECT_TRUE(command.heartbeat_expected);
    EXPECT_EQ(command.heartbeat_ns, time_ns + kSecond_ns);
    EXPECT_EQ(command.request.kind, supervisor::RequestKind::calibrate) << "the script's";
  }
}

TEST_F(Operate, ARobotThatDidNotGetWhereStartAskedIsAnErrorWithWhatItWaitedFor) {
  Options options;
  options.duration_s = 2.0;
  state->script.emplace(gait::GaitCommand{gait::GaitKind::stand, 0.0}, 1.0, options.duration_s);
  Outcome outcome;
  outcome.last_state = "ready";
  after_a_tick_at(kSecond_ns);
  check_goal(options, *state, outcome);
  EXPECT_EQ(outcome.error, "") << "there is time left";
  after_a_tick_at(3 * kSecond_ns, 1);
  check_goal(options, *state, outcome);
  EXPECT_EQ(outcome.error,
            "--start: the robot did not get there within --duration 2 s; its last state was ready");
  outcome.error.clear();
  outcome.waits = "not in a pose to stand up from: knee_L is at 1.25 rad";
  check_goal(options, *state, outcome);
  EXPECT_TRUE(outcome.error.ends_with(" 2 s; " + outcome.waits)) << outcome.error;
}

}  // namespace
}  // namespace stilt::program
