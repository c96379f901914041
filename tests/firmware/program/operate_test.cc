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

  control_loop::OperatorCommand after_a_tick_at(std::int64_t time_ns) {
    control_loop::TickRecord tick;
    tick.time_ns = time_ns;
    tick.state = supervisor::State::idle;
    state->mail.telemetry.push(tick);
    operate(*state, signals);
    return state->mail.commands.newest();
  }

  std::unique_ptr<ControllerState> state = std::make_unique<ControllerState>();
  Signals signals;
};

TEST_F(Operate, TheHeartbeatIsThatOfHousekeepingWithASecondToSpare) {
  for (const std::int64_t time_ns : {kSecond_ns, 5 * kSecond_ns}) {
    const control_loop::OperatorCommand command = after_a_tick_at(time_ns);
    EXPECT_TRUE(command.heartbeat_expected);
    EXPECT_EQ(command.heartbeat_ns, time_ns + kSecond_ns);
    EXPECT_EQ(command.request.kind, supervisor::RequestKind::calibrate) << "the script's";
  }
}

TEST_F(Operate, AStopShutsDownAndACutCuts) {
  signals.stop = true;
  EXPECT_TRUE(after_a_tick_at(kSecond_ns).shut_down);
  EXPECT_NE(after_a_tick_at(kSecond_ns).request.kind, supervisor::RequestKind::cut);
  signals.cut = true;
  EXPECT_EQ(after_a_tick_at(kSecond_ns).request.kind, supervisor::RequestKind::cut);
}

}  // namespace
}  // namespace stilt::program
