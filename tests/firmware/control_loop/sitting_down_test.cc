// From standing to the sitting pose: only at rest, with both feet down to the end of the plan.
#include <gtest/gtest.h>

#include <functional>

#include "tests/firmware/control_loop/rig.h"

namespace stilt::control_loop {
namespace {

using supervisor::RequestKind;
using supervisor::State;
using testing::Rig;

/// A robot that has stood for long enough, and is asked to sit with this as its last plan.
State state_after_sit(const std::function<void(control::Plan&)>& change) {
  Rig rig;
  rig.stand();
  rig.run(static_cast<int>(1000 * rig.configuration.supervisor.slow_down_s));
  rig.plan_once_more(change);
  rig.ask(RequestKind::sit);
  rig.run(5);
  return rig.state();
}

TEST(SittingDown, BeginsAtOnceWhenThePlanEndsWhereTheRobotIs) {
  EXPECT_EQ(state_after_sit([](control::Plan&) {}), State::sit);
}

TEST(SittingDown, WaitsForAStepThatIsPlanned) {
  const auto with_a_step = [](control::Plan& plan) {
    plan.phase_end_s = plan.node[plan.nodes - 1].time_s - 0.1;
  };
  EXPECT_EQ(state_after_sit(with_a_step), State::stand);
  EXPECT_EQ(state_after_sit([](control::Plan& plan) { plan.gait = gait::GaitKind::walk; }), State::stand);
}

TEST(SittingDown, WaitsForARobotThatMovesToTheEndOfItsPlan) {
  for (int i = 0; i < model::kFirstJoint; ++i) {
    for (const double way : {0.05, -0.05}) {
      const auto elsewhere = [&](control::Plan& plan) { plan.node[plan.nodes - 1].state[i] += way; };
      EXPECT_EQ(state_after_sit(elsewhere), State::stand) << "component " << i << ", " << way;
    }
  }
}

}  // namespace
}  // namespace stilt::control_loop
