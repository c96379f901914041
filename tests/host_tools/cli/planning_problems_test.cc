#include "host_tools/cli/planning_problems.h"

#include <gtest/gtest.h>

#include "host_tools/cli/planner_timing.h"

namespace stilt::cli {
namespace {

TEST(PlanningProblems, AreThoseOfAWalkUnderWayAndItsStartIsSolvedUntimed) {
  ControllerChoice choice;
  choice.horizon_s = 0.2;
  const PlanningProblems problems = record_walk(choice, 0.5, 20);
  EXPECT_TRUE(problems.survived);
  ASSERT_EQ(problems.inputs.size(), problems.lead + 20);
  const control::PlannerInput& first = problems.inputs[problems.lead];
  EXPECT_NEAR(first.time_s, 3.0, 0.01);
  EXPECT_GT(first.state[model::kPositions], 0.3) << "m/s: it walks";
  const auto controller =
      make_controller(controller_setup(choice, robot_model(choice.robot), controller_configuration(choice)));
  const PlannerTimings timings = time_planner(controller->planner(), problems);
  EXPECT_EQ(timings.solve_us.size(), 20u);
  EXPECT_EQ(timings.iterations.size(), 20u);
  EXPECT_EQ(timings.failed, 0);
}

}  // namespace
}  // namespace stilt::cli
