#include "host_tools/experiments/commanded_speeds.h"

#include <gtest/gtest.h>

namespace stilt::experiments {
namespace {

/// A made-up robot that is slower than its command by a tenth of a metre per second, and falls at 0.8 m/s.
log::RunRecord slow_robot(const WalkCase& walk) {
  log::RunRecord record;
  record.summary.survived = walk.command.speed_m_s < 0.8;
  record.summary.mean_speed_m_s = walk.command.speed_m_s - 0.1;
  record.summary.peak_torque_Nm << 1.0, 2.0, 3.0, 4.0;
  record.summary.heap_allocations_in_loop = 5;
  EXPECT_EQ(walk.duration_s, 60.0);
  EXPECT_EQ(walk.controller, "mpc-heuristic");
  EXPECT_EQ(walk.horizon_s, 1.0);
  EXPECT_EQ(walk.sensor_noise_scale, 1.0);
  return record;
}

Json merged() {
  SpeedPlan plan;
  plan.speeds_m_s = {0.5, 0.8, 1.5};
  std::vector<Json> results;
  for (const Job& job : speed_jobs(plan, [](const WalkCase& walk) {
         log::RunRecord record = slow_robot(walk);
         if (walk.command.speed_m_s == 1.5) record.summary.survived = true;
         return record;
       })) {
    results.push_back(job.run());
  }
  return merge_speeds(results);
}

TEST(CommandedSpeeds, ARowWalksWithinATenthOfTheCommand) {
  const Json rows = merged().at("rows");
  ASSERT_EQ(rows.size(), 3);
  EXPECT_EQ(rows[0].at("speed_m_s"), 0.5);
  EXPECT_EQ(rows[0].at("mean_speed_m_s"), 0.4);
  EXPECT_FALSE(rows[0].at("walks").get<bool>()) << "a fifth too slow";
  EXPECT_FALSE(rows[1].at("walks").get<bool>()) << "falls";
  EXPECT_TRUE(rows[2].at("walks").get<bool>());
  EXPECT_EQ(rows[0].at("peak_torque_Nm"), Json({1.0, 2.0, 3.0, 4.0}));
  EXPECT_EQ(rows[0].at("heap_allocations_in_loop"), 5);
}

TEST(CommandedSpeeds, TheTableSaysWhatFalls) {
  const std::string table = speed_table(merged());
  EXPECT_NE(table.find("| 0.50 | 0.400 | no | 5 |\n"), std::string::npos) << table;
  EXPECT_NE(table.find("| 0.80 | falls | no | 5 |\n"), std::string::npos) << table;
  EXPECT_NE(table.find("| 1.50 | 1.400 | yes | 5 |\n"), std::string::npos) << table;
}

}  // namespace
}  // namespace stilt::experiments
