#include "firmware/control_loop/planner_task.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "firmware/configuration/configuration.h"
#include "mpc_core/gait/reference.h"
#include "tests/robots.h"

namespace stilt::control_loop {
namespace {

class PlannerTaskTest : public testing::Test {
 protected:
  PlannerTaskTest()
      : configuration(configuration::load_robot("amber3m").value()),
        planner(std::make_unique<PlannerTask>()),
        plan(std::make_unique<control::Plan>()) {
    EXPECT_EQ(planner->configure(testing_support::amber3m(), configuration), control::ConfigureStatus::ok);
    request.tick = 1;
    request.stance_episode = 1;
    request.time_s = 5.0;
    request.state =
        gait::standing_state(testing_support::amber3m().constants, configuration.reference.base_height_m, 0.0,
                             configuration.gait.stand_half_width_m, true);
  }
  configuration::Configuration configuration;
  std::unique_ptr<PlannerTask> planner;
  std::unique_ptr<control::Plan> plan;
  PlanningRequest request;
};

TEST_F(PlannerTaskTest, ARequestGivesAPlanFromItsStateAndTime) {
  ASSERT_TRUE(planner->cycle(request, *plan));
  EXPECT_GE(plan->nodes, 2);
  EXPECT_EQ(plan->start_time_s, 5.0);
  EXPECT_EQ(planner->result().cycles, 1u);
  EXPECT_EQ(planner->result().stance_episode, 1u);
  EXPECT_EQ(planner->result().failures_in_a_row, 0u);
}

TEST_F(PlannerTaskTest, WithoutAStanceEpisodeNothingIsPlanned) {
  request.stance_episode = 0;
  EXPECT_FALSE(planner->cycle(request, *plan));
  EXPECT_EQ(planner->result().cycles, 0u);
}

TEST_F(PlannerTaskTest, FailuresAreCountedAndLeaveThePlanAlone) {
  ASSERT_TRUE(planner->cycle(request, *plan));
  const long long sequence = plan->sequence;
  request.state[2] = NAN;
  for (unsigned failure = 1; failure <= 3; ++failure) {
    request.time_s += 0.01;
    EXPECT_FALSE(planner->cycle(request, *plan));
    EXPECT_EQ(planner->result().failures_in_a_row, failure);
    EXPECT_EQ(planner->result().status, sqp::SolveStatus::not_finite);
  }
  EXPECT_EQ(plan->sequence, sequence);
  request.state[2] = 0.0;
  request.time_s += 0.01;
  EXPECT_TRUE(planner->cycle(request, *plan));
  EXPECT_EQ(planner->result().failures_in_a_row, 0u);
}

TEST_F(PlannerTaskTest, ANewStanceEpisodeCountsItsFailuresFromTheBeginning) {
  request.state[2] = NAN;
  EXPECT_FALSE(planner->cycle(request, *plan));
  EXPECT_FALSE(planner->cycle(request, *plan));
  request.stance_episode = 2;
  EXPECT_FALSE(planner->cycle(request, *plan));
  EXPECT_EQ(planner->result().failures_in_a_row, 1u);
}

TEST_F(PlannerTaskTest, ANewStanceEpisodeForgetsTheStepsOfTheLast) {
  ASSERT_TRUE(planner->cycle(request, *plan));
  request.command = {gait::GaitKind::walk, 0.5};
  for (int cycle = 0; cycle < 60; ++cycle) {
    request.time_s += 0.01;
    ASSERT_TRUE(planner->cycle(request, *plan));
  }
  EXPECT_EQ(plan->gait, gait::GaitKind::walk);
  request.stance_episode = 2;
  request.command = {};
  request.time_s += 0.01;
  ASSERT_TRUE(planner->cycle(request, *plan));
  EXPECT_EQ(plan->gait, gait::GaitKind::stand);
  for (int k = 0; k < plan->nodes; ++k) {
    const auto mode = plan->node[static_cast<std::size_t>(k)].mode;
    EXPECT_TRUE(mode.left && mode.right) << k;
  }
}

}  // namespace
}  // namespace stilt::control_loop
