#include "host_tools/experiments/command_sequence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace stilt::experiments {
namespace {

using gait::GaitKind;
using simulation::TimedCommand;

TEST(CommandSequence, HoldsEveryCommandForThreeToEightSecondsWithinTheSpeeds) {
  std::set<GaitKind> kinds;
  double slowest_m_s = 1.0, fastest_m_s = -1.0;
  for (std::uint32_t seed = 1; seed <= 100; ++seed) {
    const auto commands = random_commands(seed, 60.0);
    ASSERT_EQ(commands.front().start_s, 0.0) << "seed " << seed;
    for (std::size_t i = 0; i < commands.size(); ++i) {
      const TimedCommand& timed = commands[i];
      if (i > 0) {
        EXPECT_GE(timed.start_s - commands[i - 1].start_s, 3.0) << "seed " << seed;
        EXPECT_LE(timed.start_s - commands[i - 1].start_s, 8.0) << "seed " << seed;
      }
      EXPECT_LT(timed.start_s, 60.0);
      kinds.insert(timed.command.kind);
      if (timed.command.kind != GaitKind::walk) continue;
      slowest_m_s = std::min(slowest_m_s, timed.command.speed_m_s);
      fastest_m_s = std::max(fastest_m_s, timed.command.speed_m_s);
    }
    EXPECT_GE(commands.back().start_s, 52.0) << "seed " << seed;
  }
  EXPECT_EQ(kinds.size(), 3u);
  EXPECT_GE(slowest_m_s, -0.4);
  EXPECT_LT(slowest_m_s, -0.35);
  EXPECT_LE(fastest_m_s, 0.8);
  EXPECT_GT(fastest_m_s, 0.75);
}

TEST(CommandSequence, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const auto first = random_commands(3, 60.0);
  const auto again = random_commands(3, 60.0);
  ASSERT_EQ(first.size(), again.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].start_s, again[i].start_s);
    EXPECT_EQ(first[i].command.speed_m_s, again[i].command.speed_m_s);
  }
  EXPECT_NE(first[1].start_s, random_commands(4, 60.0)[1].start_s);
}

}  // namespace
}  // namespace stilt::experiments
