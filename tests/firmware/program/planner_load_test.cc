#include "firmware/program/planner_load.h"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <thread>

#include "firmware/program/configure_controller.h"

namespace stilt::program {
namespace {

using namespace std::chrono_literals;

/// A load of more than a second, in which it begins anew. No machine is too slow: only solves count.
struct PlannerLoadTest : testing::Test {
  PlannerLoadTest() {
    options.configuration = configuration::load_robot("amber3m").value();
    options.configuration.runtime.planner_priority = 0;
    options.configuration.runtime.planner_core = -1;
  }

  void run() {
    const auto ready =
        configure_controller(options.configuration, "shipped", state->planner, state->control, &state->gaits);
    ASSERT_TRUE(ready) << ready.error();
    ASSERT_TRUE(load.start());
    std::this_thread::sleep_for(1200ms);
    load.end();
  }

  Options options;
  std::unique_ptr<ControllerState> state = std::make_unique<ControllerState>();
  PlannerLoad load{options, *state};
};

TEST_F(PlannerLoadTest, EverySolveHasAPlan) {
  run();
  EXPECT_GT(load.solve().count(), 0u);
  EXPECT_EQ(load.failed(), 0);
  EXPECT_GE(load.duration_s(), 1.2);
}

TEST_F(PlannerLoadTest, SolvesWithoutAPlanAreCounted) {
  options.configuration.sqp.plan_defect_max = 0;
  run();
  EXPECT_GT(load.failed(), 0);
  EXPECT_EQ(load.failed(), static_cast<long long>(load.solve().count()));
}

}  // namespace
}  // namespace stilt::program
