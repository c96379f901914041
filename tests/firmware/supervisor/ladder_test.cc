#include "firmware/supervisor/ladder.h"

#include <gtest/gtest.h>

#include <limits>

namespace stilt::supervisor {
namespace {

const SupervisorParameters kParameters;

Rung rung(State state, Reaction reaction, bool has_plan, double plan_age_s, bool has_gait = false) {
  return choose_rung({state, reaction, has_plan, has_gait, plan_age_s}, kParameters);
}

TEST(Ladder, ANewPlanIsFollowed) {
  EXPECT_EQ(rung(State::walk, Reaction::none, true, 0.0), Rung::new_plan);
  EXPECT_EQ(rung(State::walk, Reaction::warn, true, 0.099), Rung::new_plan) << "with a warning too";
  EXPECT_EQ(rung(State::step, Reaction::slow, true, 0.01), Rung::new_plan)
      << "stopping is the planner's work";
}

TEST(Ladder, AnOlderPlanIsFollowedWithItsGainsForABoundedAge) {
  EXPECT_EQ(rung(State::walk, Reaction::none, true, 0.1), Rung::older_plan);
  EXPECT_EQ(rung(State::walk, Reaction::none, true, 0.249), Rung::older_plan);
}

TEST(Ladder, WithoutAPlanToFollowAGaitIsTracked) {
  EXPECT_EQ(rung(State::walk, Reaction::warn, true, 0.25, true), Rung::gait);
  EXPECT_EQ(rung(State::step, Reaction::none, false, 0.0, true), Rung::gait);
  EXPECT_EQ(rung(State::walk, Reaction::none, true, 0.2, true), Rung::older_plan) << "plans come first";
  EXPECT_EQ(rung(State::walk, Reaction::hold, false, 0.0, true), Rung::hold);
  EXPECT_EQ(rung(State::sit, Reaction::none, false, 0.0, true), Rung::sit) << "in states that track only";
}

TEST(Ladder, WithoutAPlanOrGaitToFollowThePoseIsHeld) {
  EXPECT_EQ(rung(State::walk, Reaction::none, true, 0.25), Rung::hold);
  EXPECT_EQ(rung(State::stand, Reaction::none, false, 0.0), Rung::hold);
  EXPECT_EQ(rung(State::stand, Reaction::none, true, std::numeric_limits<double>::quiet_NaN()), Rung::hold);
  EXPECT_EQ(rung(State::walk, Reaction::hold, true, 0.0), Rung::hold);
}

TEST(Ladder, AFaultThatAsksToSitSits) {
  EXPECT_EQ(rung(State::walk, Reaction::sit, true, 0.0), Rung::sit);
  EXPECT_EQ(rung(State::sit, Reaction::none, true, 0.0), Rung::sit);
}

TEST(Ladder, AFaultThatDampsDampsWhateverTheState) {
  for (const State state : {State::ready, State::stand, State::step, State::walk, State::sit, State::fault}) {
    EXPECT_EQ(rung(state, Reaction::damp, true, 0.0), Rung::damp) << name(state);
  }
}

TEST(Ladder, LettingGoIsTheLastRung) {
  EXPECT_EQ(rung(State::fault, Reaction::off, true, 0.0), Rung::off);
  for (const State state : {State::boot, State::idle, State::calibrate, State::off}) {
    EXPECT_EQ(rung(state, Reaction::none, true, 0.0), Rung::off) << name(state);
  }
}

TEST(Ladder, AHarderReactionNeverClimbs) {
  for (int state = 0; state < static_cast<int>(kStates); ++state) {
    for (const double age_s : {0.0, 0.1, 1.0}) {
      Rung before = Rung::new_plan;
      for (int reaction = 0; reaction <= static_cast<int>(Reaction::off); ++reaction) {
        const Rung now = rung(static_cast<State>(state), static_cast<Reaction>(reaction), true, age_s);
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
      Rung before = Rung::new_plan;
      for (double age_s = 0; age_s < 0.5; age_s += 0.001) {
        const Rung now = rung(static_cast<State>(state), Reaction::none, true, age_s, has_gait);
        EXPECT_GE(now, before);
        before = now;
      }
    }
  }
}

TEST(Ladder, PlansAreFollowedInStatesThatTrackOnly) {
  for (int state = 0; state < static_cast<int>(kStates); ++state) {
    const Rung now = rung(static_cast<State>(state), Reaction::none, true, 0.0);
    EXPECT_EQ(now == Rung::new_plan, tracks(static_cast<State>(state)));
  }
}

}  // namespace
}  // namespace stilt::supervisor
