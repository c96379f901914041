#include "firmware/supervisor/fallback.h"

#include <gtest/gtest.h>

#include <limits>

namespace stilt::supervisor {
namespace {

const SupervisorParameters kParameters;

FallbackLevel rung(State state, Reaction reaction, bool has_plan, double plan_age_s, bool has_gait = false) {
  return choose_rung({state, reaction, has_plan, has_gait, plan_age_s}, kParameters);
}

TEST(Ladder, ANewPlanIsFollowed) {
  EXPECT_EQ(rung(State::walk, Reaction::none, true, 0.0), FallbackLevel::plan);
  EXPECT_EQ(rung(State::walk, Reaction::warn, true, 0.099), FallbackLevel::plan) << "with a warning too";
  EXPECT_EQ(rung(State::step, Reaction::slow, true, 0.01), FallbackLevel::plan)
      << "stopping is the planner's work";
}

TEST(Ladder, AnOlderPlanIsFollowedWithItsGainsForABoundedAge) {
  EXPECT_EQ(rung(State::walk, Reaction::none, true, 0.1), FallbackLevel::plan_feedback);
  EXPECT_EQ(rung(State::walk, Reaction::none, true, 0.249), FallbackLevel::plan_feedback);
}

TEST(Ladder, WithoutAPlanToFollowAGaitIsTracked) {
  EXPECT_EQ(rung(State::walk, Reaction::warn, true, 0.25, true), FallbackLevel::gait);
  EXPECT_EQ(rung(State::step, Reaction::none, false, 0.0, true), FallbackLevel::gait);
  EXPECT_EQ(rung(State::walk, Reaction::none, true, 0.2, true), FallbackLevel::plan_feedback) << "plans come first";
  EXPECT_EQ(rung(State::walk, Reaction::hold, false, 0.0, true), FallbackLevel::hold);
  EXPECT_EQ(rung(State::sit, Reaction::none, false, 0.0, true), FallbackLevel::sit) << "in states that track only";
}

TEST(Ladder, WithoutAPlanOrGaitToFollowThePoseIsHeld) {
  EXPECT_EQ(rung(State::walk, Reaction::none, true, 0.25), FallbackLevel::hold);
  EXPECT_EQ(rung(State::stand, Reaction::none, false, 0.0), FallbackLevel::hold);
  EXPECT_EQ(rung(State::stand, Reaction::none, true, std::numeric_limits<double>::quiet_NaN()), FallbackLevel::hold);
  EXPECT_EQ(rung(State::walk, Reaction::hold, true, 0.0), FallbackLevel::hold);
}

TEST(Ladder, AFaultThatAsksToSitSits) {
  EXPECT_EQ(rung(State::walk, Reaction::sit, true, 0.0), FallbackLevel::sit);
  EXPECT_EQ(rung(State::sit, Reaction::none, true, 0.0), FallbackLevel::sit);
}

TEST(Ladder, AFaultThatDampsDampsWhateverTheState) {
  for (const State state : {State::ready, State::stand, State::step, State::walk, State::sit, State::fault}) {
    EXPECT_EQ(rung(state, Reaction::damp, true, 0.0), FallbackLevel::damp) << name(state);
  }
}

TEST(Ladder, LettingGoIsTheLastRung) {
  EXPECT_EQ(rung(State::fault, Reaction::off, true, 0.0), FallbackLevel::off);
  for (const State state : {State::boot, State::idle, State::calibrate, State::off}) {
    EXPECT_EQ(rung(state, Reaction::none, true, 0.0), FallbackLevel::off) << name(state);
  }
}

TEST(Ladder, AHarderReactionNeverClimbs) {
  for (int state = 0; state < static_cast<int>(kStates); ++state) {
    for (const double age_s : {0.0, 0.1, 1.0}) {
      FallbackLevel before = FallbackLevel::plan;
      for (int reaction = 0; reaction <= static_cast<int>(Reaction::off); ++reaction) {
        const FallbackLevel now = rung(static_cast<State>(state), static_cast<Reaction>(reaction), true, age_s);
        EXPECT_GE(now, before) << name(static_cast<State>(state)) << " "
                               << name(static_cast<Reaction>(reaction));
        before = now;
      }
    }
  }
}

TEST(Ladder, AnOlderPlanNeverClimbs) {
  for (const bool has_gait : {false, true}) {
    for (int state = 0; state < static_cast<int>(kStates); ++state) {
      FallbackLevel before = FallbackLevel::plan;
      for (double age_s = 0; age_s < 0.5; age_s += 0.001) {
        const FallbackLevel now = rung(static_cast<State>(state), Reaction::none, true, age_s, has_gait);
        EXPECT_GE(now, before);
        before = now;
      }
    }
  }
}

TEST(Ladder, PlansAreFollowedInStatesThatTrackOnly) {
  for (int state = 0; state < static_cast<int>(kStates); ++state) {
    const FallbackLevel now = rung(static_cast<State>(state), Reaction::none, true, 0.0);
    EXPECT_EQ(now == FallbackLevel::plan, tracks(static_cast<State>(state)));
  }
}

}  // namespace
}  // namespace stilt::supervisor
