#include "firmware/control_loop/start_script.h"

#include <gtest/gtest.h>

#include "tests/firmware/supervisor/printers.h"

namespace stilt::control_loop {
namespace {

using supervisor::RequestKind;
using supervisor::State;

TEST(StartScript, WithoutAGoalItAsksForNothing) {
  StartScript script(std::nullopt, 1.0, 0.0);
  for (const State state : {State::boot, State::idle, State::ready}) {
    EXPECT_EQ(script.command(0.0, state, 0.0).request.kind, RequestKind::none);
  }
}

TEST(StartScript, GoesFromIdleToAWalkStepByStep) {
  StartScript script(gait::GaitCommand{gait::GaitKind::walk, 0.4}, 1.0, 0.0);
  EXPECT_EQ(script.command(0.0, State::boot, 0).request.kind, RequestKind::none);
  EXPECT_EQ(script.command(0.1, State::idle, 0).request.kind, RequestKind::calibrate);
  EXPECT_EQ(script.command(0.2, State::calibrate, 0).request.kind, RequestKind::calibrate);
  EXPECT_EQ(script.command(0.3, State::ready, 0).request.kind, RequestKind::stand);
  EXPECT_EQ(script.command(0.4, State::stand, 0.1).request.kind, RequestKind::stand);
  EXPECT_EQ(script.command(1.3, State::stand, 1).request.kind, RequestKind::stand) << "settles from 0.4 s on";
  const OperatorCommand walk = script.command(2.5, State::stand, 1);
  EXPECT_EQ(walk.request.kind, RequestKind::walk);
  EXPECT_EQ(walk.request.speed_m_s, 0.4);
  EXPECT_EQ(walk.request.number, 3u);
}

TEST(StartScript, AfterAFaultItAsksForNothingAgain) {
  StartScript script(gait::GaitCommand{gait::GaitKind::stand, 0}, 0.0, 0.0);
  static_cast<void>(script.command(0.1, State::idle, 0));
  const auto number = script.command(0.3, State::ready, 0).request.number;
  for (const State state : {State::fault, State::idle, State::ready, State::stand}) {
    EXPECT_EQ(script.command(1.0, state, 0).request.number, number);
  }
}

TEST(StartScript, ShutsDownAtTheEndOfTheDurationAndStaysSo) {
  StartScript script(std::nullopt, 0.0, 2.0);
  EXPECT_FALSE(script.command(1.999, State::idle, 0).shut_down);
  EXPECT_TRUE(script.command(2.0, State::idle, 0).shut_down);
  StartScript forever(std::nullopt, 0.0, 0.0);
  EXPECT_FALSE(forever.command(1e6, State::idle, 0).shut_down);
}

TEST(StartScript, MissesAGoalThatItWasNotAtWhenTheDurationEnded) {
  using gait::GaitKind;
  struct Run {
    GaitKind goal;
    State state;
    double ramp;
    bool missed;
  };
  for (const Run& run :
       {Run{GaitKind::stand, State::ready, 0.0, true}, Run{GaitKind::stand, State::stand, 0.9, true},
        Run{GaitKind::stand, State::stand, 1.0, false}, Run{GaitKind::step, State::stand, 1.0, true},
        Run{GaitKind::step, State::step, 1.0, false}, Run{GaitKind::walk, State::step, 1.0, true},
        Run{GaitKind::walk, State::walk, 1.0, false}}) {
    StartScript script(gait::GaitCommand{run.goal, 0.3}, 1.0, 2.0);
    static_cast<void>(script.command(1.0, run.state, run.ramp));
    static_cast<void>(script.command(1.5, State::ready, 0.0));
    EXPECT_FALSE(script.missed()) << "there is time left";
    static_cast<void>(script.command(2.0, run.state, 1.0));
    EXPECT_EQ(script.missed(), run.missed) << name(run.state) << ' ' << run.ramp;
  }
  StartScript idle(std::nullopt, 1.0, 2.0);
  static_cast<void>(idle.command(2.0, State::idle, 0.0));
  EXPECT_FALSE(idle.missed()) << "without a goal";
}

}  // namespace
}  // namespace stilt::control_loop
