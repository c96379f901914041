#include "firmware/supervisor/fallback.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/firmware/supervisor/printers.h"

namespace stilt::supervisor {
namespace {

const SupervisorParameters kParameters;

FallbackLevel level(State state, Reaction reaction, bool has_plan, double plan_age_s, bool has_gait = false) {
  return select_level(state, reaction,
                      {.plan = plan_use(has_plan, plan_age_s, kParameters), .gait = has_gait});
}

TEST(Fallback, ANewPlanIsFollowed) {
  EXPECT_EQ(level(State::walk, Reaction::none, true, 0.0), FallbackLevel::plan);
  EXPECT_EQ(level(State::walk, Reaction::warn, true, 0.099), FallbackLevel::plan) << "with a warning too";
  EXPECT_EQ(level(State::step, Reaction::slow, true, 0.01), FallbackLevel::plan)
      << "stopping is the planner's work";
}

TEST(Fallback, AnOlderPlanIsFollowedWithItsGainsForABoundedAge) {
  EXPECT_EQ(level(State::walk, Reaction::none, true, 0.1), FallbackLevel::plan_feedback);
  EXPECT_EQ(level(State::walk, Reaction::none, true, 0.249), FallbackLevel::plan_feedback);
}

TEST(Fallback, WithoutAPlanToFollowAGaitIsTracked) {
  EXPECT_EQ(level(State::walk, Reaction::warn, true, 0.25, true), FallbackLevel::gait);
  EXPECT_EQ(level(State::step, Reaction::none, false, 0.0, true), FallbackLevel::gait);
  EXPECT_EQ(level(State::walk, Reaction::none, true, 0.2, true), FallbackLevel::plan_feedback)
      << "plans come first";
  EXPECT_EQ(level(State::walk, Reaction::hold, false, 0.0, true), FallbackLevel::hold);
  EXPECT_EQ(level(State::sit, Reaction::none, false, 0.0, true), FallbackLevel::sit)
      << "in states that track only";
}

TEST(Fallback, ASelectedGaitIsPreferredToPlansOnceItIsInStep) {
  for (const PlanUse plan : {PlanUse::none, PlanUse::as_it_is, PlanUse::with_feedback}) {
    const Followable in_step{.plan = plan, .gait = true, .gait_selected = true};
    EXPECT_EQ(select_level(State::walk, Reaction::none, in_step), FallbackLevel::gait);
    EXPECT_EQ(select_level(State::walk, Reaction::hold, in_step), FallbackLevel::hold);
    EXPECT_EQ(select_level(State::sit, Reaction::none, in_step), FallbackLevel::sit);
  }
  const Followable not_in_step{.plan = PlanUse::as_it_is, .gait_selected = true};
  EXPECT_EQ(select_level(State::walk, Reaction::none, not_in_step), FallbackLevel::plan);
}

TEST(Fallback, WithoutAPlanOrGaitToFollowThePoseIsHeld) {
  EXPECT_EQ(level(State::walk, Reaction::none, true, 0.25), FallbackLevel::hold);
  EXPECT_EQ(level(State::stand, Reaction::none, false, 0.0), FallbackLevel::hold);
  EXPECT_EQ(level(State::stand, Reaction::none, true, std::numeric_limits<double>::quiet_NaN()),
            FallbackLevel::hold);
  EXPECT_EQ(level(State::walk, Reaction::hold, true, 0.0), FallbackLevel::hold);
}

TEST(Fallback, AFaultThatAsksToSitSits) {
  EXPECT_EQ(level(State::walk, Reaction::sit, true, 0.0), FallbackLevel::sit);
  EXPECT_EQ(level(State::sit, Reaction::none, true, 0.0), FallbackLevel::sit);
}

TEST(Fallback, AFaultThatDampsDampsWhateverTheState) {
  for (const State state : {State::ready, State::stand, State::step, State::walk, State::sit, State::fault}) {
    EXPECT_EQ(level(state, Reaction::damp, true, 0.0), FallbackLevel::damp) << name(state);
  }
}

TEST(Fallback, DisabledMotorsAreTheLastLevel) {
  EXPECT_EQ(level(State::fault, Reaction::off, true, 0.0), FallbackLevel::off);
  for (const State state : {State::boot, State::idle, State::calibrate, State::off, State::watch}) {
    EXPECT_EQ(level(state, Reaction::none, true, 0.0), FallbackLevel::off) << name(state);
  }
}

TEST(Fallback, AHarderReactionNeverClimbs) {
  for (int state = 0; state < static_cast<int>(kStates); ++state) {
    for (const double age_s : {0.0, 0.1, 1.0}) {
      FallbackLevel before = FallbackLevel::plan;
      for (int reaction = 0; reaction <= static_cast<int>(Reaction::off); ++reaction) {
        const FallbackLevel now =
            level(static_cast<State>(state), static_cast<Reaction>(reaction), true, age_s);
        EXPECT_GE(now, before) << name(static_cast<State>(state)) << " "
                               << name(static_cast<Reaction>(reaction));
        before = now;
      }
    }
  }
}

TEST(Fallback, AnOlderPlanNeverClimbs) {
  for (const bool has_gait : {false, true}) {
    for (int state = 0; state < static_cast<int>(kStates); ++state) {
      FallbackLevel before = FallbackLevel::plan;
      for (double age_s = 0; age_s < 0.5; age_s += 0.001) {
        const FallbackLevel now = level(static_cast<State>(state), Reaction::none, true, age_s, has_gait);
        EXPECT_GE(now, before);
        before = now;
      }
    }
  }
}

TEST(Fallback, PlansAreFollowedInStatesThatTrackOnly) {
  for (int state = 0; state < static_cast<int>(kStates); ++state) {
    const FallbackLevel now = level(static_cast<State>(state), Reaction::none, true, 0.0);
    EXPECT_EQ(now == FallbackLevel::plan, tracks(static_cast<State>(state)));
  }
}

TEST(Fallback, ANumberThatIsNoLevelAndNoReactionHasAName) {
  for (std::size_t number = kFallbackLevels; number < 256; ++number) {
    EXPECT_STREQ(name(static_cast<FallbackLevel>(number)), "unknown");
  }
  for (std::size_t number = kReactions; number < 256; ++number) {
    EXPECT_STREQ(name(static_cast<Reaction>(number)), "unknown");
  }
  EXPECT_STREQ(name(FallbackLevel::off), "off");
  EXPECT_STREQ(name(Reaction::off), "off");
}

}  // namespace
}  // namespace stilt::supervisor
