#include "host_tools/experiments/walks.h"

#include <gtest/gtest.h>

namespace stilt::experiments {
namespace {

using gait::GaitKind;

log::RunSummary at_speed(double speed_m_s) {
  log::RunSummary summary;
  summary.survived = true;
  summary.mean_speed_m_s = speed_m_s;
  return summary;
}

TEST(Walks, WithinTenPercentOfTheCommand) {
  EXPECT_TRUE(walks({GaitKind::walk, 0.5}, at_speed(0.45)));
  EXPECT_TRUE(walks({GaitKind::walk, 0.5}, at_speed(0.55)));
  EXPECT_FALSE(walks({GaitKind::walk, 0.5}, at_speed(0.449)));
  EXPECT_FALSE(walks({GaitKind::walk, 0.5}, at_speed(0.551)));
  EXPECT_FALSE(walks({GaitKind::walk, 0.1}, at_speed(0.12))) << "0.03 m/s is for zero alone";
}

TEST(Walks, BackwardWithinTenPercentToo) {
  EXPECT_TRUE(walks({GaitKind::walk, -0.4}, at_speed(-0.37)));
  EXPECT_FALSE(walks({GaitKind::walk, -0.4}, at_speed(-0.35)));
  EXPECT_FALSE(walks({GaitKind::walk, -0.4}, at_speed(0.4)));
}

TEST(Walks, AtZeroWithinThreeCentimetresASecond) {
  for (const gait::GaitCommand command :
       {gait::GaitCommand{GaitKind::walk, 0.0}, gait::GaitCommand{GaitKind::step, 0.5}}) {
    EXPECT_TRUE(walks(command, at_speed(-0.03)));
    EXPECT_TRUE(walks(command, at_speed(0.03)));
    EXPECT_FALSE(walks(command, at_speed(0.031)));
    EXPECT_FALSE(walks(command, at_speed(-0.031)));
  }
}

TEST(Walks, NotWhenItFalls) {
  log::RunSummary fallen = at_speed(0.5);
  fallen.survived = false;
  EXPECT_FALSE(walks({GaitKind::walk, 0.5}, fallen));
}

TEST(Walks, StandingIsWithoutAStep) {
  log::RunSummary standing = at_speed(0.0);
  EXPECT_TRUE(walks({GaitKind::stand, 0.0}, standing));
  standing.steps.push_back({5.0, "L", 0.1});
  EXPECT_FALSE(walks({GaitKind::stand, 0.0}, standing));
  EXPECT_TRUE(walks({GaitKind::step, 0.0}, standing));
}

}  // namespace
}  // namespace stilt::experiments
