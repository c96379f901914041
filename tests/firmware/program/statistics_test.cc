// Statistics of a run on the clock, and what the torque loop gets of a solve.
#include <gtest/gtest.h>

#include <memory>

#include "firmware/program/controller_state.h"

namespace stilt::program {
namespace {

TEST(LoopStatistics, ATickIsLateAboveTheLimit) {
  LoopStatistics loop;
  for (const std::int64_t latency_ns : {0, 499'999, 500'000, 500'001, 900'000}) {
    loop.add_tick(latency_ns, 2 * latency_ns, 500'000);
  }
  EXPECT_EQ(loop.ticks, 5);
  EXPECT_EQ(loop.late_ticks, 2);
  EXPECT_EQ(loop.wakeup_latency.max_us(), 900);
  EXPECT_EQ(loop.execution.max_us(), 1800);
}

class StatisticsTest : public testing::Test {
 protected:
  std::unique_ptr<ControllerState> state = std::make_unique<ControllerState>();
};

TEST_F(StatisticsTest, EveryOneIsInTheOutcome) {
  state->loop.ticks = 101;
  state->loop.late_ticks = 7;
  state->loop.missed_periods = 11;
  state->loop.heap_allocations = 2;
  state->loop.page_faults = 3;
  state->loop.wakeup_latency.add_ns(1'000'000);
  state->loop.execution.add_ns(2'000'000);
  state->loop.bus_round_trip.add_ns(3'000'000);
  state->planning.plans = 13;
  state->planning.heap_allocations = 30;
  state->planning.page_faults = 50;
  state->planning.solve.add_ns(4'000'000);
  Outcome outcome;
  take_statistics(*state, outcome);
  EXPECT_EQ(outcome.ticks, 101);
  EXPECT_EQ(outcome.late_ticks, 7);
  EXPECT_EQ(outcome.missed_periods, 11);
  EXPECT_EQ(outcome.plans, 13);
  EXPECT_EQ(outcome.heap_allocations, 2 + 30);
  EXPECT_EQ(outcome.page_faults, 3 + 50);
  EXPECT_EQ(outcome.wakeup_latency_us.max_us, 1000);
  EXPECT_EQ(outcome.execution_us.max_us, 2000);
  EXPECT_EQ(outcome.bus_round_trip_us.max_us, 3000);
  EXPECT_EQ(outcome.solve_us.max_us, 4000);
}

TEST_F(StatisticsTest, EventsThatWereDroppedAreInTheOutcome) {
  state->loop.ticks = 1;
  for (std::size_t i = 0; i < control_loop::EventRing::capacity() + 5; ++i) state->mail.events.push({});
  Outcome outcome;
  take_statistics(*state, outcome);
  EXPECT_EQ(outcome.dropped_events, 5u);
}

/// The supervisor reports planner_overrun by the duration in the result.
TEST_F(StatisticsTest, ASolveIsCountedAndRecordedAndItsResultHasItsDuration) {
  control_loop::PlanningRequest request;
  request.tick = 70;
  request.stance_episode = 1;
  finish_cycle(*state, request, false, 12'000'000);
  EXPECT_EQ(state->mail.results.newest().solve_ns, 12'000'000);
  EXPECT_FALSE(state->mail.plans.has_news()) << "none that can be used";
  ASSERT_NE(state->mail.cycles.front(), nullptr);
  EXPECT_EQ(state->mail.cycles.front()->solve_ns, 12'000'000);
  EXPECT_EQ(state->planning.plans, 1);
  EXPECT_EQ(state->planning.solve.max_us(), 12'000);
  finish_cycle(*state, request, true, 3'000'000);
  EXPECT_EQ(state->mail.results.newest().solve_ns, 3'000'000);
  EXPECT_TRUE(state->mail.plans.has_news());
  EXPECT_EQ(state->planning.plans, 2);
}

}  // namespace
}  // namespace stilt::program
