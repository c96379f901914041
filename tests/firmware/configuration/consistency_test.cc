#include "firmware/configuration/consistency.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "firmware/configuration/schema.h"
#include "mpc_core/control/plan.h"
#include "mpc_core/gait/swing.h"

namespace stilt::configuration {
namespace {

/// The first contradiction's message and key after a change of the defaults; empty when there is none.
std::string complaint(const std::function<void(Parameters&)>& change) {
  Parameters parameters;
  change(parameters);
  const auto found = contradictions(parameters);
  return found.empty() ? "" : std::string(found.front().keys.front()) + ": " + found.front().message;
}

TEST(Consistency, TheDefaultsDoNotContradictEachOther) { EXPECT_TRUE(contradictions(Parameters{}).empty()); }

TEST(Consistency, TheWholeCapacityOfTheHorizonMayBeUsed) {
  EXPECT_EQ(complaint([](Parameters& p) { p.discretisation.horizon_s = 2.0; }), "");
  EXPECT_EQ(
      complaint([](Parameters& p) { p.discretisation.horizon_s = control::kMaxHorizonIntervals * 0.015; }),
      "");
  EXPECT_EQ(complaint([](Parameters& p) {
              p.discretisation.time_step_s = 0.03;
              p.discretisation.horizon_s = 4.0;
            }),
            "");
}

TEST(Consistency, AHorizonOverCapacityIsRefusedWithTheLongestPossible) {
  EXPECT_EQ(complaint([](Parameters& p) { p.discretisation.horizon_s = 2.02; }),
            "discretisation.horizon_s: a horizon of 2.02 s in time steps of 0.015 s takes 135 intervals, the "
            "capacity "
            "is 134; the horizon may be at most 2.01 s");
  EXPECT_NE(complaint([](Parameters& p) {
              p.discretisation.time_step_s = 0.005;
              p.discretisation.horizon_s = 1.0;
            }),
            "");
}

TEST(Consistency, TooManySwitchesInTheHorizonAreRefused) {
  // Both ends of the horizon at a switch. 2 s of 0.1 s steps: 21 switches, the capacity. With 0.05 s between
  // them: 14 touch-downs, at 0.15 s k, and as many lift-offs, at 0.05 s + 0.15 s k, k = 0 to 13.
  const auto shortest_steps = [](Parameters& p) {
    p.gait.single_support_s = 0.1;
    p.discretisation.horizon_s = 2.0;
  };
  EXPECT_EQ(complaint(shortest_steps), "");
  EXPECT_NE(complaint([&](Parameters& p) {
              shortest_steps(p);
              p.gait.double_support_s = 0.05;
            }).find("28 contact switches"),
            std::string::npos);
}

// 1 / 3 s and the delay of 2 ms are more than 0.25 s.
TEST(Consistency, APlanComesBeforeTheOneBeforeItIsStale) {
  EXPECT_EQ(complaint([](Parameters& p) { p.timing.plan_rate_hz = 5.0; }), "");
  EXPECT_EQ(complaint([](Parameters& p) { p.timing.plan_rate_hz = 4.0, p.timing.plan_delay_s = 0.0; }), "");
  EXPECT_EQ(
      complaint([](Parameters& p) { p.timing.plan_rate_hz = 3.2, p.timing.plan_delay_s = 0.0; }),
      "timing.plan_delay_s: a plan is at least timing.plan_delay_s + 1 / timing.plan_rate_hz = 0.3125 s old "
      "when the next one comes, which must be at most supervisor.stale_plan_s = 0.25");
  EXPECT_NE(complaint([](Parameters& p) { p.timing.plan_delay_s = 0.25; }), "");
  EXPECT_EQ(complaint([](Parameters& p) { p.timing.plan_delay_s = 0.198; }), "")
      << "stilt experiment limits: plans get 0.396 s old, and a gait leads the robot meanwhile";
  EXPECT_EQ(complaint([](Parameters& p) {
              p.timing.plan_rate_hz = 3.0;
              p.supervisor.stale_plan_s = 0.4;
            }),
            "");
}

TEST(Consistency, AStandingRobotHasRoomForItsCapturePoint) {
  EXPECT_EQ(complaint([](Parameters& p) { p.gait.catch_margin_m = 0.14; }), "");
  EXPECT_EQ(
      complaint([](Parameters& p) { p.gait.catch_margin_m = 0.15; }),
      "gait.catch_margin_m: gait.catch_margin_m = 0.15 must be below gait.stand_half_width_m = 0.15: no "
      "place between the feet would be free of steps");
  EXPECT_EQ(complaint([](Parameters& p) { p.gait.catch_margin_m = 0.15, p.gait.catch_falls = false; }), "");
}

// Steps of 0.25 s.
TEST(Consistency, AWalkSlowsDownForTwoStepsBeforeItStands) {
  EXPECT_EQ(complaint([](Parameters& p) { p.supervisor.slow_down_s = 0.5; }), "");
  EXPECT_EQ(complaint([](Parameters& p) { p.supervisor.slow_down_s = 0.49; }),
            "supervisor.slow_down_s: supervisor.slow_down_s = 0.49 must be at least two steps, 2 "
            "(gait.single_support_s + gait.double_support_s) = 0.5; a walk would stand and sit before it has "
            "slowed down");
  EXPECT_NE(complaint([](Parameters& p) { p.supervisor.slow_down_s = 0; }), "");
  EXPECT_NE(complaint([](Parameters& p) {
              p.supervisor.slow_down_s = 0.5;
              p.gait.double_support_s = 0.05;
            }).find(" = 0.6;"),
            std::string::npos);
}

/// The bound is that of the profile itself, not of a peak at half time: 16 apex / T.
TEST(Consistency, ASwingMayComeDownAsFastAsItStaysAboveTheGround) {
  for (const double height_m : {0.02, 0.06, 0.1}) {
    for (const double time_s : {0.25, 0.4, 1.0}) {
      const double fastest_m_s = -16.0 * height_m / time_s;
      for (const double share : {0.55, 0.999, 1.05, 1.5}) {
        const auto at = [&](Parameters& p) {
          p.gait.swing_height_m = height_m;
          p.gait.single_support_s = time_s;
          p.supervisor.slow_down_s = 2.0 * time_s;
          p.gait.touchdown_velocity_m_s = share * fastest_m_s;
        };
        double lowest_m = 0.0;
        for (int i = 0; i <= 1000; ++i) {
          const double s = 1e-3 * i;
          lowest_m =
              std::min(lowest_m, gait::swing_height(height_m, share * fastest_m_s, s, time_s).position);
        }
        EXPECT_EQ(complaint(at).empty(), lowest_m >= -1e-12) << height_m << ' ' << time_s << ' ' << share;
      }
    }
  }
  EXPECT_TRUE(complaint([](Parameters& p) {
                p.gait.swing_height_m = 0.03, p.gait.touchdown_velocity_m_s = -2.0;
              }).ends_with("it must be at least -1.92"));
}

TEST(Consistency, EachOtherContradictionNamesItsKeyFirst) {
  const auto starts = [](const std::string& text, std::string_view key) { return text.starts_with(key); };
  EXPECT_PRED2(starts, complaint([](Parameters& p) { p.timing.plan_rate_hz = 1500.0; }),
               "timing.plan_rate_hz");
  EXPECT_PRED2(starts, complaint([](Parameters& p) {
                 p.discretisation.horizon_s = 0.2;
                 p.timing.plan_delay_s = 0.2;
               }),
               "timing.plan_delay_s");
  EXPECT_PRED2(starts, complaint([](Parameters& p) { p.discretisation.merge_below_s = 0.01; }),
               "discretisation.merge_below_s");
  EXPECT_PRED2(starts, complaint([](Parameters& p) { p.gait.double_support_s = 0.001; }),
               "gait.double_support_s");
  EXPECT_PRED2(starts, complaint([](Parameters& p) {
                 p.gait.touchdown_velocity_m_s = -2.0;
                 p.gait.swing_height_m = 0.03;
               }),
               "gait.touchdown_velocity_m_s");
  EXPECT_PRED2(starts, complaint([](Parameters& p) { p.estimator.blend_s = 0.11; }), "estimator.blend_s");
  EXPECT_PRED2(starts, complaint([](Parameters& p) {
                 p.sqp.filter_violation_max = 1e-6, p.sqp.filter_violation_min = 1e-3;
               }),
               "sqp.filter_violation_min");
  EXPECT_PRED2(starts, complaint([](Parameters& p) {
                 p.discretisation.time_step_s = 0.1;
                 p.discretisation.horizon_s = 0.05;
               }),
               "discretisation.horizon_s");
  EXPECT_PRED2(starts, complaint([](Parameters& p) { p.equality.stance_kd_1_s = 134; }),
               "equality.stance_kd_1_s");
  EXPECT_PRED2(starts, complaint([](Parameters& p) { p.equality.swing_kd_1_s = 134; }),
               "equality.swing_kd_1_s");
  EXPECT_PRED2(starts, complaint([](Parameters& p) { p.equality.swing_kp_1_s2 = 2700; }),
               "equality.swing_kp_1_s2");
  EXPECT_EQ(complaint([](Parameters& p) { p.equality = {133, 2600, 20, 1e-3}; }), "");
}

}  // namespace
}  // namespace stilt::configuration
