#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "tests/closed_loop/simulated_run.h"
#include "tests/firmware/supervisor/printers.h"

/// What the robot does when plans are missing for a while.
namespace stilt::simulation {
namespace {

using supervisor::FallbackLevel;
using supervisor::State;
using testing_support::describe;
using testing_support::parameters_of;
using testing_support::RunRequest;
using testing_support::SimulatedRun;
using testing_support::walking;

constexpr double kTick_s = 0.001;

bool within(double time_s, double start_s, double duration_s) {
  return time_s > start_s - 0.5 * kTick_s && time_s < start_s + duration_s - 0.5 * kTick_s;
}

/// The planner rests for a while each second from 5 s on.
log::RunRecord walk_with_rests(SimulatedRun& run, double rest_s) {
  run.settings.observer.plans = [rest_s](double time_s) {
    return time_s < 5.0 || !within(time_s - std::floor(time_s + 0.5 * kTick_s), 0.2, rest_s);
  };
  return run.run();
}

double time_at(const log::RunRecord& record, FallbackLevel level) {
  return record.summary.fallback_s[static_cast<std::size_t>(level)];
}

/// Plans of 15 s with ten rests.
std::size_t plans_with_rests(const SimulatedRun& run, double rest_s) {
  return static_cast<std::size_t>(std::lround(run.parameters.timing.plan_rate_hz * (15.0 - 10.0 * rest_s)));
}

TEST(Fallback, APlanMissingNowAndThenIsReplacedByTheOlderOne) {
  SimulatedRun run(walking(0.5, 1.0, 15.0));
  const log::RunRecord record = walk_with_rests(run, 0.01);
  EXPECT_EQ(record.solves.size(), plans_with_rests(run, 0.01));
  EXPECT_TRUE(record.summary.survived) << describe(run, record);
  EXPECT_NEAR(record.summary.mean_speed_m_s, 0.5, 0.05);
  EXPECT_NEAR(time_at(record, FallbackLevel::plan), 15.0, 1e-6);
}

TEST(Fallback, AHundredMillisecondsWithoutAPlanAreWalkedOnTheOlderOneWithItsGains) {
  SimulatedRun run(walking(0.5, 1.0, 15.0));
  const log::RunRecord record = walk_with_rests(run, 0.1);
  EXPECT_EQ(record.solves.size(), plans_with_rests(run, 0.1));
  EXPECT_TRUE(record.summary.survived) << describe(run, record);
  EXPECT_NEAR(record.summary.mean_speed_m_s, 0.5, 0.05);
  // The plan before a rest is as old as the rest one period before the next, which becomes active after its
  // delay.
  const control::TimingParameters& timing = run.parameters.timing;
  EXPECT_NEAR(time_at(record, FallbackLevel::plan_feedback),
              10.0 * (1.0 / timing.plan_rate_hz + timing.plan_delay_s), 10.0 * kTick_s);
  EXPECT_EQ(time_at(record, FallbackLevel::gait), 0.0);
}

TEST(Fallback, EightTenthsOfASecondWithoutAPlanAreWalkedOnAGait) {
  SimulatedRun run(walking(0.5, 1.0, 15.0));
  const log::RunRecord record = walk_with_rests(run, 0.8);
  EXPECT_TRUE(record.summary.survived) << describe(run, record);
  // From 0.25 s and at most one step of 0.3 s on.
  EXPECT_GT(time_at(record, FallbackLevel::gait), 10.0 * (0.8 - 0.25 - 0.3));
  EXPECT_GT(time_at(record, FallbackLevel::plan), 5.0) << "and plans are followed again";
}

/// A tick at which state, level or faults change.
struct Change {
  std::uint64_t tick;
  State state;
  FallbackLevel level;
  std::uint64_t faults;
};

std::vector<Change> changes(const RunRequest& request, const RunSettings& faults) {
  SimulatedRun run(request);
  run.settings.planner_until_s = faults.planner_until_s;
  run.settings.faults = faults.faults;
  std::vector<Change> found;
  run.settings.observer.ticked = [&](const control_loop::TickRecord& tick) {
    const Change now{tick.tick, tick.state, tick.level, tick.present.bits()};
    const bool same = !found.empty() && found.back().state == now.state && found.back().level == now.level &&
                      found.back().faults == now.faults;
    if (!same) found.push_back(now);
  };
  (void)run.run();
  return found;
}

TEST(Fallback, APlannerThatStopsAndAnEncoderThatFreezesLeadDownToDamping) {
  RunSettings faults;
  faults.planner_until_s = 5.0;
  faults.faults = {parse_fault("encoder-freeze:knee_L@8")};
  const std::vector<Change> seen = changes(walking(0.5, 1.0, 12.0), faults);
  std::vector<FallbackLevel> levels;
  for (const Change& change : seen) {
    if (levels.empty() || levels.back() != change.level) levels.push_back(change.level);
  }
  EXPECT_EQ(levels, (std::vector{FallbackLevel::plan, FallbackLevel::plan_feedback, FallbackLevel::gait,
                                 FallbackLevel::damp}));
  ASSERT_FALSE(seen.empty());
  EXPECT_EQ(seen.back().state, State::fault);
  const auto last_plan = static_cast<std::uint64_t>(
      std::lround(5000.0 - 1000.0 / parameters_of(walking(0.5, 1.0, 12.0)).timing.plan_rate_hz));
  EXPECT_EQ(seen[1].tick, last_plan + 100);
  // A step of the plan lasts 0.25 s, and 0.05 s on both feet.
  EXPECT_GE(seen[2].tick, last_plan + 250);
  EXPECT_LE(seen[2].tick, last_plan + 250 + 300);
}

/// Whenever in two steps the plans end, the robot walks on for 4 s on the gait. At other speeds a part of
/// the moments ends in a fall: docs/decisions/0041-the-gait-takes-over-at-a-touch-down.md.
TEST(Fallback, PlansMayEndAtAnyMomentOfAStep) {
  constexpr int kMoments = 10;
  for (const double speed_m_s : {0.1, 0.5, 0.7}) {
    for (int i = 0; i < kMoments; ++i) {
      SimulatedRun run(walking(speed_m_s, 1.0, 10.0));
      run.settings.planner_until_s = 5.0 + 0.6 * i / kMoments;
      const log::RunRecord record = run.run();
      EXPECT_TRUE(record.summary.survived)
          << speed_m_s << " m/s, plans until " << run.settings.planner_until_s;
      EXPECT_GT(time_at(record, FallbackLevel::gait), 3.5);
    }
  }
}

/// Moments at which a gait that takes over at once, not at the next touch-down, ends in a fall.
TEST(Fallback, TheGaitTakesOverAtATouchDown) {
  for (const double until_s : {5.12, 5.15, 5.36, 5.39, 5.42}) {
    SimulatedRun run(walking(0.3, 1.0, 10.0));
    run.settings.planner_until_s = until_s;
    EXPECT_TRUE(run.run().summary.survived) << "plans until " << until_s;
  }
}

/// A short plan ends soon after the touch-down at which the gait is to take over: on the foot that landed.
TEST(Fallback, TheGaitTakesOverAtTheLastTouchDownOfAPlan) {
  SimulatedRun run(walking(0.5, 0.6, 10.0));
  run.settings.planner_until_s = 4.1;
  const log::RunRecord record = run.run();
  EXPECT_TRUE(record.summary.survived) << describe(run, record);
}

/// Without a planner: on the gait for planner_lost_s, in place, then it sits. There the run ends, as with a
/// fall.
TEST(Fallback, ALostPlannerEndsSitting) {
  RunRequest request = walking(0.5, 1.0, 16.0);
  request.settings = {"supervisor.planner_lost_s=5"};
  RunSettings faults;
  faults.planner_until_s = 5.0;
  const std::vector<Change> seen = changes(request, faults);
  std::vector<State> states;
  for (const Change& change : seen) {
    if (states.empty() || states.back() != change.state) states.push_back(change.state);
  }
  // Out of a step, without a plan to balance it: it tips over while it sits, and that is a fall.
  EXPECT_EQ(states, (std::vector{State::walk, State::step, State::stand, State::sit, State::fault}));
  const auto first = [&seen](State state) { return *std::ranges::find(seen, state, &Change::state); };
  EXPECT_GT(first(State::fault).tick, first(State::sit).tick + 500) << "it falls slowly";
  EXPECT_TRUE(supervisor::FaultSet(first(State::fault).faults).has(supervisor::Fault::base_pitch_limit));
}

/// The planner's steps take another time than the gait's 0.3 s. After a minute of the gait, and at any time
/// within its step, the robot stops as out of plans.
TEST(Fallback, AStopOutOfASelectedGaitStandsWhateverThePlannersStepTime) {
  for (const char* step :
       {"gait.single_support_s=0.25", "gait.single_support_s=0.3", "gait.single_support_s=0.4"}) {
    for (const double stop_s : {8.0, 8.1, 8.2, 60.05}) {
      RunRequest request = walking(0.3, 1.0, stop_s + 4.0);
      request.settings = {step, "supervisor.select_gait=true", "supervisor.select_gait_after_s=1"};
      request.commands.push_back({stop_s, {gait::GaitKind::stand, 0.0}});
      SimulatedRun run(request);
      State state = State::boot;
      FallbackLevel level = FallbackLevel::off;
      run.settings.observer.ticked = [&](const control_loop::TickRecord& tick) {
        state = tick.state;
        level = tick.level;
        EXPECT_TRUE(tick.present.empty()) << step << ", " << static_cast<double>(tick.tick) * kTick_s << " s";
      };
      const log::RunRecord record = run.run();
      EXPECT_TRUE(record.summary.survived)
          << step << ", stop at " << stop_s << " s, " << describe(run, record);
      EXPECT_GT(time_at(record, FallbackLevel::gait), stop_s - 3.0);
      EXPECT_EQ(state, State::stand);
      EXPECT_EQ(level, FallbackLevel::plan);
    }
  }
}

}  // namespace
}  // namespace stilt::simulation
