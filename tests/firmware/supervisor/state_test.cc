#include "firmware/supervisor/state.h"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <set>
#include <vector>

#include "tests/firmware/supervisor/printers.h"

// The table of transitions, as a table.
namespace stilt::supervisor {
namespace {

using States = std::array<bool, kStates>;

std::size_t index(State state) { return static_cast<std::size_t>(state); }

/// States that can be reached from one over transitions that `may_use` accepts.
template <class Filter>
States reachable(State from, const Filter& may_use) {
  States seen{};
  seen[index(from)] = true;
  for (std::size_t round = 0; round < kStates; ++round) {
    for (const Transition& transition : kTransitions) {
      if (seen[index(transition.from)] && may_use(transition)) seen[index(transition.to)] = true;
    }
  }
  return seen;
}

TEST(TransitionTable, EveryStateOfTheControllerIsReachedFromBoot) {
  const States seen = reachable(State::boot, [](const Transition&) { return true; });
  for (std::size_t i = 0; i < kStates; ++i) {
    const auto state = static_cast<State>(i);
    EXPECT_EQ(seen[i], state != State::watch) << name(state);
  }
}

TEST(TransitionTable, EveryStateOfTheControllerButOffHasAnExit) {
  States has_exit{};
  for (const Transition& transition : kTransitions) has_exit[index(transition.from)] = true;
  for (std::size_t i = 0; i < kStates; ++i) {
    const auto state = static_cast<State>(i);
    EXPECT_EQ(has_exit[i], state != State::off && state != State::watch) << name(state);
  }
}

TEST(TransitionTable, OffIsReachedFromEveryStateByShuttingDownAndWaiting) {
  const auto ends = [](const Transition& transition) {
    return transition.condition == Condition::shut_down || transition.condition == Condition::sit_done ||
           transition.condition == Condition::bring_up_done;
  };
  for (std::size_t i = 0; i < kStates; ++i) {
    const auto state = static_cast<State>(i);
    EXPECT_EQ(reachable(state, ends)[index(State::off)], state != State::watch) << name(state);
  }
}

TEST(TransitionTable, FromFaultThereIsNoWayToTorqueButByReset) {
  const States seen = reachable(State::fault, [](const Transition& transition) {
    return transition.condition != Condition::request_reset;
  });
  for (std::size_t i = 0; i < kStates; ++i) {
    const auto state = static_cast<State>(i);
    EXPECT_EQ(seen[i], state == State::fault || state == State::off) << name(state);
  }
}

TEST(TransitionTable, AResetNeedsEveryCauseGoneAndEndsWithoutTorque) {
  for (const Transition& transition : kTransitions) {
    if (transition.condition != Condition::request_reset) continue;
    EXPECT_EQ(transition.from, State::fault);
    EXPECT_EQ(transition.guard, Guard::causes_gone);
    EXPECT_EQ(transition.to, State::idle);
  }
}

TEST(TransitionTable, TorqueIsReachedFromReadyByStandingUpOnly) {
  for (const Transition& transition : kTransitions) {
    if (has_torque(transition.from) || !has_torque(transition.to)) continue;
    EXPECT_EQ(transition.from, State::ready);
    EXPECT_EQ(transition.condition, Condition::request_stand);
    EXPECT_EQ(transition.guard, Guard::fit_to_stand);
    EXPECT_EQ(transition.to, State::stand);
  }
}

TEST(TransitionTable, DriversAreBroughtUpBeforeTheyAreDriven) {
  const States without = reachable(State::boot, [](const Transition& transition) {
    return transition.condition != Condition::bring_up_done;
  });
  for (std::size_t i = 0; i < kStates; ++i) {
    const auto state = static_cast<State>(i);
    EXPECT_FALSE(without[i] && drives(state) && state != State::fault) << name(state);
  }
}

TEST(TransitionTable, ACutComesFirstAndThenAFaultThatDamps) {
  std::map<State, std::vector<Transition>> ways;
  for (const Transition& transition : kTransitions) ways[transition.from].push_back(transition);
  for (const auto& [from, of_state] : ways) {
    SCOPED_TRACE(name(from));
    EXPECT_EQ(of_state[0].condition, Condition::request_cut);
    EXPECT_EQ(of_state[0].guard, Guard::always);
    EXPECT_EQ(of_state[0].to, State::off);
    if (from == State::boot || from == State::fault) continue;
    EXPECT_EQ(of_state[1].condition, Condition::damp_fault);
    EXPECT_EQ(of_state[1].guard, Guard::always);
    EXPECT_EQ(of_state[1].to, State::fault);
  }
}

TEST(TransitionTable, DampedJointsGoLimpAtOnceByACutAlone) {
  for (const Transition& transition : kTransitions) {
    if (!damps(transition.from) || transition.to != State::off) continue;
    const bool cut = transition.condition == Condition::request_cut;
    EXPECT_EQ(transition.guard, cut ? Guard::always : Guard::damped) << name(transition.from);
  }
}

TEST(TransitionTable, WalkingEndsOverSteppingInPlaceUnlessAFaultForbids) {
  for (const Transition& transition : kTransitions) {
    if (transition.from != State::walk) continue;
    const bool forbids = transition.condition == Condition::request_cut ||
                         transition.condition == Condition::damp_fault ||
                         transition.guard == Guard::cannot_step;
    EXPECT_EQ(transition.to == State::step, !forbids);
  }
}

TEST(TransitionTable, SittingBeginsFromStandingUnlessThereIsNothingToStepWith) {
  for (const Transition& transition : kTransitions) {
    if (transition.to != State::sit) continue;
    const bool waits_for_both_feet = transition.from == State::stand && transition.guard == Guard::at_rest;
    EXPECT_TRUE(waits_for_both_feet || transition.guard == Guard::cannot_step) << name(transition.from);
  }
}

TEST(TransitionTable, NoTransitionIsTwiceThereAndNoneLeadsNowhere) {
  std::set<std::array<int, 3>> seen;
  for (const Transition& transition : kTransitions) {
    EXPECT_NE(transition.from, transition.to);
    EXPECT_TRUE(seen.insert({static_cast<int>(transition.from), static_cast<int>(transition.condition),
                             static_cast<int>(transition.guard)})
                    .second);
  }
}

TEST(State, ANumberThatIsNoStateHasANameAndADescription) {
  for (std::size_t number = kStates; number < 256; ++number) {
    EXPECT_STREQ(name(static_cast<State>(number)), "unknown");
    EXPECT_STREQ(description(static_cast<State>(number)), "Unknown to this program");
  }
  EXPECT_STREQ(name(State::watch), "watch");
}

}  // namespace
}  // namespace stilt::supervisor
