#include "host_tools/simulation/robot_on_bus/walk_recorder.h"

#include <gtest/gtest.h>

#include "tests/host_tools/simulation/plant/test_robots.h"

namespace stilt::robot_on_bus {
namespace {

/// A gantry releases a robot somewhere, after feet that slid on the way there.
TEST(WalkRecorder, DistanceAndSlipCountFromTheRelease) {
  using namespace simulation;
  Plant plant = amber_plant();
  const model::StateVector posture = standing_state(kAmberLeg, kHipHeight_m, 0.15);
  model::StateVector sliding = posture;
  sliding[model::kPositions] = 1.0;
  plant.set_state(sliding);
  hold(plant, posture, 0.05);
  const double release_x_m = plant.state()[0];
  const double release_slip_m = plant.slip_distance_m();
  ASSERT_GT(release_x_m, 0.01);
  ASSERT_GT(release_slip_m, 0.001);

  WalkRecorder recorder(false);
  recorder.begin(plant);
  hold(plant, posture, 0.02);
  recorder.finish(0.02, plant, Fall::none);
  const log::RunSummary& summary = recorder.record().summary;
  EXPECT_GT(summary.slip_distance_m, 0.0);
  EXPECT_DOUBLE_EQ(summary.slip_distance_m, plant.slip_distance_m() - release_slip_m);
  EXPECT_DOUBLE_EQ(summary.distance_m, plant.state()[0] - release_x_m);
}

}  // namespace
}  // namespace stilt::robot_on_bus
