#include "host_tools/recording/replay/replay.h"

#include <gtest/gtest.h>

#include <bit>
#include <expected>
#include <functional>
#include <string>
#include <utility>

#include "tests/firmware/supervisor/printers.h"
#include "tests/host_tools/recording/replay/recorded_walk.h"
#include "tests/robots.h"

namespace stilt::replay {
namespace {

using control_loop::CycleRecord;
using control_loop::TickRecord;

std::expected<Tunings, std::string> recorded_tunings(std::uint32_t number) {
  const auto found = recorded_walk().tunings.find(number);
  if (found == recorded_walk().tunings.end()) return std::unexpected("is missing in the record");
  return found->second;
}

Outcome replayed(const std::vector<TickRecord>& ticks, const std::vector<CycleRecord>& cycles,
                 const configuration::Configuration& configuration) {
  Replay replay(cycles, recorded_tunings);
  replay.loop().configure(testing_support::amber3m(), configuration, configuration.supervisor);
  EXPECT_EQ(replay.planner().configure(testing_support::amber3m(), configuration),
            control::ConfigureStatus::ok);
  for (const TickRecord& tick : ticks) {
    if (!replay.run(tick)) break;
  }
  return replay.outcome();
}

class ReplayTest : public testing::Test {
 protected:
  [[nodiscard]] Outcome run() const { return replayed(ticks, cycles, recorded_walk().configuration); }

  /// Flips the last bit.
  static void nudge(double& number) {
    number = std::bit_cast<double>(std::bit_cast<std::uint64_t>(number) ^ 1);
  }

  std::vector<TickRecord> ticks = recorded_walk().ticks;
  std::vector<CycleRecord> cycles = recorded_walk().cycles;
};

TEST_F(ReplayTest, TheRecordedRunWalks) {
  EXPECT_EQ(ticks.back().state, supervisor::State::walk);
  EXPECT_GT(cycles.size(), 250u);
  EXPECT_GT(ticks.back().estimated_state[0], 0.1);
  EXPECT_EQ(ticks.back().tuning, 2u);
  EXPECT_EQ(cycles.back().tuning, 2u);
}

TEST_F(ReplayTest, EveryPlanAndTorqueComesOutTheSame) {
  const Outcome outcome = run();
  EXPECT_TRUE(outcome.reproduced()) << outcome.problem
                                    << (outcome.difference ? outcome.difference->text() : "");
  EXPECT_EQ(outcome.ticks, ticks.size());
  EXPECT_EQ(outcome.cycles, cycles.size());
}

TEST_F(ReplayTest, OneBitOfATorqueIsFoundInItsTick) {
  nudge(ticks[2345].sent[3].torque_Nm);
  const Outcome outcome = run();
  ASSERT_TRUE(outcome.difference);
  EXPECT_EQ(outcome.difference->tick, 2345u);
  EXPECT_EQ(outcome.difference->what, "sent torque_Nm of knee_R");
  EXPECT_NE(outcome.difference->recorded, outcome.difference->replayed);
  EXPECT_EQ(outcome.ticks, 2345u);
  EXPECT_FALSE(outcome.reproduced());
}

TEST_F(ReplayTest, NothingIsRunAfterADifference) {
  Replay replay(cycles, recorded_tunings);
  const configuration::Configuration& configuration = recorded_walk().configuration;
  replay.loop().configure(testing_support::amber3m(), configuration, configuration.supervisor);
  ASSERT_EQ(replay.planner().configure(testing_support::amber3m(), configuration),
            control::ConfigureStatus::ok);
  nudge(ticks[20].sent[0].position_rad);
  for (std::size_t tick = 0; tick < 20; ++tick) ASSERT_TRUE(replay.run(ticks[tick]));
  for (std::size_t tick = 20; tick < 30; ++tick) EXPECT_FALSE(replay.run(ticks[tick]));
  ASSERT_TRUE(replay.outcome().difference);
  EXPECT_EQ(replay.outcome().difference->tick, 20u);
  EXPECT_EQ(replay.outcome().ticks, 20u);
  EXPECT_EQ(replay.outcome().problem, "");
}

TEST_F(ReplayTest, OneBitOfAPlanIsFoundInTheTickItStartsFrom) {
  cycles[100].checksum ^= 1u << 20;
  const Outcome outcome = run();
  ASSERT_TRUE(outcome.difference);
  EXPECT_EQ(outcome.difference->tick, static_cast<std::uint64_t>(cycles[100].tick));
  EXPECT_EQ(outcome.difference->what, "check sum of the plan");
}

/// What the controller gives for a solve is its own, not the record's.
TEST_F(ReplayTest, ASolveThatDiffersFromTheRecordIsFound) {
  const std::pair<const char*, std::function<void(CycleRecord&)>> changes[] = {
      {"time_s of the plan's request", [](CycleRecord& solve) { nudge(solve.time_s); }},
      {"stance episode of the plan's request", [](CycleRecord& solve) { ++solve.stance_episode; }},
      {"status of the solve", [](CycleRecord& solve) { solve.report.status = sqp::SolveStatus::not_convex; }},
      {"failures in a row", [](CycleRecord& solve) { ++solve.failures; }},
      {"sequence of the plan", [](CycleRecord& solve) { ++solve.plan_sequence; }},
      {"nodes of the plan", [](CycleRecord& solve) { ++solve.nodes; }},
  };
  for (const auto& [what, change] : changes) {
    cycles = recorded_walk().cycles;
    change(cycles[100]);
    const Outcome outcome = run();
    ASSERT_TRUE(outcome.difference) << what;
    EXPECT_EQ(outcome.difference->what, what);
    EXPECT_EQ(outcome.cycles, 100u) << what;
  }
}

TEST_F(ReplayTest, OneBitOfASensorIsFoundInWhatFollowsFromIt) {
  nudge(ticks[2000].joints[1].velocity_rad_s);
  const Outcome outcome = run();
  ASSERT_TRUE(outcome.difference);
  EXPECT_EQ(outcome.difference->tick, 2000u);
}

TEST_F(ReplayTest, AnotherConfigurationIsFound) {
  configuration::Configuration other = recorded_walk().configuration;
  other.cost.terminal *= 0.5;
  const Outcome outcome = replayed(ticks, cycles, other);
  EXPECT_TRUE(outcome.difference);
}

TEST_F(ReplayTest, AMissingTickIsReported) {
  ticks.erase(ticks.begin() + 1200);
  const Outcome outcome = run();
  EXPECT_FALSE(outcome.reproduced());
  EXPECT_EQ(outcome.ticks, 1200u);
  EXPECT_EQ(outcome.problem.find("tick 1200 is missing"), 0u) << outcome.problem;
}

TEST_F(ReplayTest, AMissingBeginningIsReported) {
  ticks.erase(ticks.begin(), ticks.begin() + 50);
  const Outcome outcome = run();
  EXPECT_EQ(outcome.ticks, 0u);
  EXPECT_EQ(outcome.problem.find("ticks 0 to 49 are missing"), 0u) << outcome.problem;
}

TEST_F(ReplayTest, AMissingSolveIsReported) {
  cycles.erase(cycles.begin() + 40);
  EXPECT_EQ(run().problem.find("plan 40, there in tick "), 0u) << run().problem;
  cycles[40].tick = recorded_walk().cycles[40].tick;  // before its plan would become active
  const Outcome outcome = run();
  EXPECT_EQ(outcome.problem.find("solve 41 of the planner is missing"), 0u) << outcome.problem;
  EXPECT_FALSE(outcome.difference);
}

TEST_F(ReplayTest, ATuningThatTheRecordLacksIsReported) {
  ticks[1700].tuning = 3;
  const Outcome outcome = run();
  EXPECT_EQ(outcome.ticks, 1700u);
  EXPECT_NE(outcome.problem.find("tuning 3"), std::string::npos) << outcome.problem;
}

TEST_F(ReplayTest, ATuningOfASolveThatTheRecordLacksIsReported) {
  cycles[60].tuning = 9;
  const Outcome outcome = run();
  EXPECT_EQ(outcome.cycles, 60u);
  EXPECT_NE(outcome.problem.find("tuning 9 of solve 61"), std::string::npos) << outcome.problem;
}

TEST_F(ReplayTest, ASolveOfATickThatIsOverIsReportedAsOutOfOrder) {
  cycles[60].tick = cycles[59].tick - 1;
  const Outcome outcome = run();
  EXPECT_EQ(outcome.cycles, 60u);
  EXPECT_NE(outcome.problem.find("solve 61 of the planner belongs to tick"), std::string::npos)
      << outcome.problem;
}

TEST_F(ReplayTest, APlanThatNoSolveHasMadeIsReported) {
  ticks[900].visible_plan += 1'000'000;
  const Outcome outcome = run();
  EXPECT_EQ(outcome.ticks, 900u);
  EXPECT_NE(outcome.problem.find("there in tick 900, is missing"), std::string::npos) << outcome.problem;
}

TEST_F(ReplayTest, NothingIsNotReproduced) {
  EXPECT_FALSE(replayed({}, {}, recorded_walk().configuration).reproduced());
}

}  // namespace
}  // namespace stilt::replay
