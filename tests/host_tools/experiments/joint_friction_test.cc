#include "host_tools/experiments/joint_friction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace stilt::experiments {
namespace {

using model::kFirstJoint;

bool has(const std::vector<std::string>& list, const std::string& text) {
  return std::ranges::find(list, text) != list.end();
}

/// Joint errors of a made-up robot: in every second sample one joint is off by `error_rad`, the base always.
log::RunRecord robot_off_by(double error_rad) {
  log::RunRecord record;
  record.summary.survived = true;
  record.samples.resize(4);
  for (std::size_t i = 0; i < record.samples.size(); ++i) {
    log::RunSample& sample = record.samples[i];
    sample.planned_state.setZero();
    sample.true_state.setConstant(7.0);
    sample.true_state.segment<model::kJoints>(kFirstJoint).setZero();
    if (i % 2 == 0) sample.planned_state[kFirstJoint + 1] = error_rad;
  }
  return record;
}

std::vector<Json> results(const FrictionPlan& plan, const WalkRunner& run) {
  std::vector<Json> all;
  for (const Job& job : friction_jobs(plan, run)) all.push_back(job.run());
  return all;
}

TEST(JointFriction, TheErrorIsTheRootMeanSquareOverJointsAndSamples) {
  FrictionPlan plan;
  plan.rates = {{100.0, 0.01}};
  const Json row = merge_friction(plan, results(plan,
                                                [](const WalkCase& walk) {
                                                  if (walk.plant.empty()) return robot_off_by(0.04);
                                                  return robot_off_by(walk.settings.size() > 2 ? 0.08 : 0.16);
                                                }))
                       .at("rows")
                       .at(0);
  // One of four joints, half of the samples: the square is an eighth.
  EXPECT_NEAR(row.at("no_friction_rad").get<double>(), 0.04 / std::sqrt(8.0), 1e-12);
  EXPECT_NEAR(row.at("unknown_rad").get<double>(), 0.16 / std::sqrt(8.0), 1e-12);
  EXPECT_NEAR(row.at("configured_rad").get<double>(), 0.08 / std::sqrt(8.0), 1e-12);
  EXPECT_NEAR(row.at("configured_over_unknown").get<double>(), 0.5, 1e-12);
  EXPECT_TRUE(row.at("survived").get<bool>());
}

TEST(JointFriction, EveryRateHasJointsWithoutWithUnknownAndWithConfiguredFriction) {
  const FrictionPlan plan;
  std::vector<WalkCase> walks;
  const auto all = results(plan, [&](const WalkCase& walk) {
    walks.push_back(walk);
    log::RunRecord record = robot_off_by(0.1);
    record.summary.survived = walks.size() != 2;
    return record;
  });
  ASSERT_EQ(walks.size(), 12);
  for (std::size_t i = 0; i < walks.size(); ++i) {
    const WalkCase& walk = walks[i];
    EXPECT_EQ(has(walk.plant, "joint_friction_Nm=5"), i % 3 != 0);
    for (const char* joint : {"hip", "knee"}) {
      EXPECT_EQ(has(walk.settings, std::string("robot.") + joint + "_coulomb_friction_Nm=5"), i % 3 == 2);
    }
    EXPECT_EQ(walk.sensor_noise_scale, 0.0);
    EXPECT_TRUE(walk.keep_samples && walk.sample_every_tick);
  }
  EXPECT_TRUE(has(walks[0].settings, "timing.plan_rate_hz=25"));
  EXPECT_TRUE(has(walks[11].settings, "timing.plan_delay_s=0.002"));
  const Json rows = merge_friction(plan, all).at("rows");
  EXPECT_FALSE(rows[0].at("survived").get<bool>()) << "one of its three fell";
  EXPECT_TRUE(rows[1].at("survived").get<bool>());
  EXPECT_NE(friction_table({{"rows", rows}}).find("| 25 | 0.02 | "), std::string::npos);
}

}  // namespace
}  // namespace stilt::experiments
