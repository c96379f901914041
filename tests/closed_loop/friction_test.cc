#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/closed_loop/simulated_run.h"

/// Joints with Coulomb friction, known to the controller or not.
namespace stilt::simulation {
namespace {

using model::kFirstJoint;
using model::kJoints;
using testing_support::describe;
using testing_support::RunRequest;
using testing_support::SimulatedRun;

/// Root mean square over time and joints of planned less true joint position, 20 s at 0.5 m/s. Of every
/// control tick: a step lasts a whole number of 5 ms, so that slower samples show the same few phases of it.
/// Each plan starts at the measured state and is 20 ms old when it becomes active, or one period of plans.
double joint_error_rms_rad(double plans_per_s, const std::string& friction,
                           const std::vector<std::string>& settings) {
  RunRequest request = testing_support::walking(0.5, 1.0, 20.0);
  request.settings = settings;
  request.settings.push_back("timing.plan_rate_hz=" + std::to_string(plans_per_s));
  request.settings.push_back("timing.plan_delay_s=" + std::to_string(std::min(0.02, 1.0 / plans_per_s)));
  request.plant = {friction};
  request.keep_samples = true;
  SimulatedRun run(request);
  run.settings.sample_rate_hz = run.parameters.timing.torque_rate_hz;
  const log::RunRecord record = run.run();
  EXPECT_TRUE(record.summary.survived) << describe(run, record);
  double sum = 0.0;
  for (const log::RunSample& sample : record.samples) {
    const model::StateVector error = sample.planned_state - sample.true_state;
    sum += error.segment<kJoints>(kFirstJoint).squaredNorm();
  }
  return std::sqrt(sum / (kJoints * static_cast<double>(record.samples.size())));
}

class Friction : public ::testing::TestWithParam<double> {};

TEST_P(Friction, CompensationOfFiveNewtonMetresLeavesTheJointErrorOfJointsWithout) {
  const std::vector<std::string> known = {"robot.hip_coulomb_friction_Nm=5",
                                          "robot.knee_coulomb_friction_Nm=5"};
  const double none_rad = joint_error_rms_rad(GetParam(), "joint_friction_Nm=0", {});
  const double without_rad = joint_error_rms_rad(GetParam(), "joint_friction_Nm=5", {});
  const double with_rad = joint_error_rms_rad(GetParam(), "joint_friction_Nm=5", known);
  std::printf("rms joint error: %.2e rad without friction, %.2e with it, %.2e compensated\n", none_rad,
              without_rad, with_rad);
  EXPECT_LE(with_rad, 0.6 * without_rad);
  EXPECT_LE(with_rad, 1.1 * none_rad);
}

INSTANTIATE_TEST_SUITE_P(PlansPerSecond, Friction, ::testing::Values(25.0, 50.0, 100.0),
                         [](const auto& test) { return std::to_string(std::lround(test.param)); });

}  // namespace
}  // namespace stilt::simulation
