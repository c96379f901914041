#include "mpc_core/ocp/horizon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/mpc_core/printers.h"

namespace stilt::ocp {
namespace {

using gait::ContactSchedule;
using gait::GaitKind;

/// A random gait under way, and a grid on it from a random time.
struct RandomGrid {
  ContactSchedule schedule;
  DiscretisationParameters parameters;
  double start_s = 0.0;
  Horizon horizon;
  bool fits = false;

  explicit RandomGrid(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    gait::GaitParameters gait;
    gait.single_support_s = 0.2 + 0.6 * uniform(random);
    // From none over some too short for a node of their own to long ones.
    gait.double_support_s = seed % 3 == 0 ? 0.0 : (seed % 3 == 1 ? 0.004 : 0.2) * uniform(random);
    parameters.horizon_s = 0.1 + 1.9 * uniform(random);
    const gait::ReferenceParameters reference;
    const GaitKind kind = seed % 2 == 0 ? GaitKind::walk : GaitKind::step;
    start_s = 3.0 * uniform(random);
    schedule.reset(0.0);
    schedule.update(0.0, 6.0, {kind, 0.4}, gait, reference, 0.0, true);
    schedule.update(start_s, start_s + 6.0, {kind, 0.4}, gait, reference, 0.4, true);
    // Every fifth grid starts, or ends, next to a switch.
    if (seed % 5 == 0 && schedule.count() > 3) {
      const double near_s = schedule.phase(schedule.count() / 2).start_s + 0.006 * (uniform(random) - 0.5);
      (seed % 2 == 0 ? start_s : parameters.horizon_s) =
          seed % 2 == 0 ? near_s : std::min(2.0, near_s - start_s);
      parameters.horizon_s = std::max(parameters.horizon_s, 0.05);
    }
    fits = build_horizon(schedule, start_s, parameters, horizon);
  }
};

template <class Check>
void for_random_grids(const Check& check) {
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const RandomGrid grid(seed);
    ASSERT_TRUE(grid.fits);
    check(grid);
    if (testing::Test::HasFailure()) return;
  }
}

const Stage& stage_of(const RandomGrid& grid, int k) {
  return grid.horizon.stage[static_cast<std::size_t>(k)];
}

TEST(Horizon, CoversTheTimeFromStartToEndWithoutGapOrOverlap) {
  for_random_grids([](const RandomGrid& grid) {
    EXPECT_EQ(stage_of(grid, 0).time_s, grid.start_s);
    EXPECT_EQ(grid.horizon.end_s, grid.start_s + grid.parameters.horizon_s);
    for (int k = 0; k < grid.horizon.stages; ++k) {
      const Stage& stage = stage_of(grid, k);
      EXPECT_NEAR(stage.time_s + stage.duration_s, grid.horizon.node_time_s(k + 1), 1e-12) << "stage " << k;
    }
    EXPECT_EQ(grid.horizon.node_time_s(grid.horizon.stages), grid.horizon.end_s);
  });
}

TEST(Horizon, LeavesNoSliverAndNoIntervalMuchLongerThanTheTimeStep) {
  for_random_grids([](const RandomGrid& grid) {
    for (int k = 0; k < grid.horizon.stages; ++k) {
      const Stage& stage = stage_of(grid, k);
      if (stage.kind == StageKind::transition) {
        EXPECT_EQ(stage.duration_s, 0.0);
        continue;
      }
      EXPECT_GE(stage.duration_s, grid.parameters.merge_below_s - 1e-12)
          << "stage " << k << " of " << grid.horizon.stages;
      EXPECT_LE(stage.duration_s, grid.parameters.time_step_s + 2.0 * grid.parameters.merge_below_s + 1e-12);
    }
  });
}

/// Distance of a switch from the nearest node, s.
double distance_s(const Horizon& horizon, double switch_s) {
  double nearest_s = 1.0;
  for (int k = 0; k <= horizon.stages; ++k) {
    nearest_s = std::min(nearest_s, std::abs(horizon.node_time_s(k) - switch_s));
  }
  return nearest_s;
}

TEST(Horizon, HasANodeAtEveryContactSwitchButForOneJustBehindItsStartOrAnother) {
  for_random_grids([](const RandomGrid& grid) {
    const double merge_s = grid.parameters.merge_below_s;
    for (int phase = 1; phase < grid.schedule.count(); ++phase) {
      const double switch_s = grid.schedule.phase(phase).start_s;
      if (switch_s <= grid.start_s || switch_s >= grid.horizon.end_s - merge_s) continue;
      const double behind_s = std::max(grid.start_s, grid.schedule.phase(phase - 1).start_s);
      const bool is_merged = switch_s <= behind_s + merge_s;
      EXPECT_LE(distance_s(grid.horizon, switch_s), is_merged ? merge_s + 1e-12 : 0.0)
          << "switch at " << switch_s;
    }
  });
}

TEST(Horizon, HasANodeAtEachSwitchThatIsAsFarBehindTheGridAsIntervalsAreMerged) {
  const gait::GaitParameters gait{.single_support_s = 0.25};
  const DiscretisationParameters parameters;
  ContactSchedule schedule;
  schedule.reset(0.0);
  schedule.update(0.0, 10.0, {GaitKind::walk, 0.4}, gait, {}, 0.0, true);
  for (int plan = 0; plan < 4000; ++plan) {
    const double start_s = 0.002 * plan;
    schedule.update(start_s, start_s + 2.0, {GaitKind::walk, 0.4}, gait, {}, 0.4, true);
    Horizon horizon;
    ASSERT_TRUE(build_horizon(schedule, start_s, parameters, horizon));
    for (int phase = schedule.index_at(start_s + 1.5 * parameters.merge_below_s) + 1;
         phase < schedule.count(); ++phase) {
      const double switch_s = schedule.phase(phase).start_s;
      if (switch_s >= horizon.end_s - parameters.merge_below_s) break;
      ASSERT_EQ(distance_s(horizon, switch_s), 0.0) << "start " << start_s << ", switch " << switch_s;
    }
  }
}

TEST(Horizon, GivesEachIntervalTheModeOfItsMiddleUpToTheMergedTime) {
  for_random_grids([](const RandomGrid& grid) {
    for (int k = 0; k < grid.horizon.stages; ++k) {
      const Stage& stage = stage_of(grid, k);
      if (stage.kind == StageKind::transition) continue;
      const double middle_s = stage.time_s + 0.5 * stage.duration_s;
      EXPECT_GE(stage.phase, grid.schedule.index_at(middle_s)) << "stage " << k;
      EXPECT_LE(stage.phase, grid.schedule.index_at(middle_s + grid.parameters.merge_below_s))
          << "stage " << k;
      EXPECT_EQ(stage.mode, grid.schedule.phase(stage.phase).mode);
    }
  });
}

TEST(Horizon, PutsATransitionWhereverAFootComesDownAndNowhereElse) {
  for_random_grids([](const RandomGrid& grid) {
    model::ContactMode mode = grid.schedule.phase(grid.schedule.index_at(grid.start_s)).mode;
    for (int k = 0; k < grid.horizon.stages; ++k) {
      const Stage& stage = stage_of(grid, k);
      const bool left = stage.mode.left && !mode.left;
      const bool right = stage.mode.right && !mode.right;
      EXPECT_EQ(stage.kind == StageKind::transition, left || right) << "stage " << k;
      EXPECT_EQ(stage.touchdown[0], left);
      EXPECT_EQ(stage.touchdown[1], right);
      mode = stage.mode;
    }
  });
}

TEST(Horizon, BeginsWithTheTouchDownWhenItStartsOnASwitchHoweverSumsAreRounded) {
  ContactSchedule schedule;
  schedule.reset(0.0);
  const gait::GaitParameters gait{.single_support_s = 0.3};
  const DiscretisationParameters parameters;
  schedule.update(0.0, 4.0, {GaitKind::walk, 0.4}, gait, {}, 0.0, true);  // first lift-off at 0.3
  for (int step = 2; step < 400; ++step) {
    // The switch is a sum of step times, the start a multiple of a millisecond.
    const double start_s = 0.001 * (300 * step);
    schedule.update(start_s, start_s + 4.0, {GaitKind::walk, 0.4}, gait, {}, 0.4, true);
    Horizon horizon;
    ASSERT_TRUE(build_horizon(schedule, start_s, parameters, horizon));
    EXPECT_EQ(horizon.stage[0].kind, StageKind::transition) << "start " << start_s;
    EXPECT_EQ(horizon.stage[0].time_s, start_s);
  }
}

TEST(Horizon, SlidesWithTheStart) {
  ContactSchedule schedule;
  schedule.reset(0.0);
  const DiscretisationParameters parameters;
  Horizon horizon;
  ASSERT_TRUE(build_horizon(schedule, 0.0037, parameters, horizon));
  for (int k = 0; k < 60; ++k) EXPECT_NEAR(horizon.node_time_s(k), 0.0037 + 0.015 * k, 1e-12);
}

TEST(Horizon, StaysExactAfterAnHour) {
  ContactSchedule schedule;
  schedule.reset(0.0);
  const DiscretisationParameters parameters;
  Horizon horizon;
  ASSERT_TRUE(build_horizon(schedule, 3600.0, parameters, horizon));
  EXPECT_EQ(horizon.stages, 67);
  for (int k = 0; k < 67; ++k) EXPECT_NEAR(horizon.node_time_s(k), 3600.0 + 0.015 * k, 1e-9);
}

TEST(Horizon, OfTwoSecondsFitsWithTheMostSwitchesItIsMadeFor) {
  gait::GaitParameters gait;
  gait.single_support_s = 0.15;
  gait.double_support_s = 0.05;  // 20 switches in 2 s
  ContactSchedule schedule;
  schedule.reset(0.0);
  schedule.update(0.0, 4.0, {GaitKind::walk, 0.3}, gait, {}, 0.0, true);
  DiscretisationParameters parameters;
  parameters.horizon_s = 2.0;
  Horizon horizon;
  for (double start_s = 0.3; start_s < 0.5; start_s += 0.0007) {
    ASSERT_TRUE(build_horizon(schedule, start_s, parameters, horizon)) << "start " << start_s;
  }
}

TEST(Horizon, RefusesWhatDoesNotFit) {
  ContactSchedule schedule;
  schedule.reset(0.0);
  DiscretisationParameters parameters;
  Horizon horizon;
  parameters.horizon_s = 4.0;
  EXPECT_FALSE(build_horizon(schedule, 0.0, parameters, horizon));
  parameters.horizon_s = 1.0;
  parameters.time_step_s = 0.004;
  EXPECT_FALSE(build_horizon(schedule, 0.0, parameters, horizon));
}

TEST(Horizon, MostSwitchesBoundsEveryWindowOfARandomGait) {
  const unsigned seed = 20250607;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> single(0.1, 1.0), both(0.01, 0.5), horizon(0.05, 3.0);
  for (int trial = 0; trial < 200; ++trial) {
    gait::GaitParameters gait;
    gait.single_support_s = single(random);
    gait.double_support_s = trial % 2 == 0 ? 0.0 : both(random);
    DiscretisationParameters grid;
    grid.horizon_s = horizon(random);
    // Switches of a long walk; every window that starts at a switch, where the count peaks.
    std::vector<double> times;
    double time_s = 0.0;
    for (int step = 0; step < 100; ++step) {
      times.push_back(time_s += gait.single_support_s);
      if (gait.double_support_s > 0.0) times.push_back(time_s += gait.double_support_s);
    }
    double most = 0.0;
    for (auto first = times.begin(); first != times.begin() + 4; ++first) {
      const auto last = std::upper_bound(first, times.end(), *first + grid.horizon_s);
      most = std::max(most, static_cast<double>(last - first));
    }
    EXPECT_EQ(most_switches(grid, gait), most) << "seed " << seed << ", trial " << trial;
  }
}

}  // namespace
}  // namespace stilt::ocp
