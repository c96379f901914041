#include <gtest/gtest.h>

#include "tests/closed_loop/simulated_run.h"

namespace stilt::simulation {
namespace {

using testing_support::describe;
using testing_support::RunRequest;
using testing_support::SimulatedRun;

/// A URDF that is not shipped, without a configuration: controller and plant take their numbers from it.
TEST(OwnRobot, WalksHalfAMinuteThroughThirtyFiveNewtons) {
  RunRequest request = testing_support::walking(0.5, 1.0, 30.0);
  request.robot = STILT_TEST_DATA "/robots/heavy.urdf";
  request.pushes = {{35.0, 10.0, 1.0, PushPoint::hip}};
  SimulatedRun run(request);
  EXPECT_NEAR(run.plant.mass_kg(), 15.5 + 2.0 * (3.4261 + 1.15), 1e-9);
  const log::RunRecord record = run.run();
  ASSERT_TRUE(record.summary.survived) << describe(run, record);
  EXPECT_NEAR(record.summary.mean_speed_m_s, 0.5, 0.05) << describe(run, record);
}

}  // namespace
}  // namespace stilt::simulation
