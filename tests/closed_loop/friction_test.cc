#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/closed_loop/published_results.h"
#include "tests/closed_loop/simulated_run.h"

/// Joints with Coulomb friction, known to the controller or not: the figures of docs/results/friction.json.
namespace stilt::simulation {
namespace {

using experiments::Json;
using model::kFirstJoint;
using model::kJoints;
using testing_support::describe;
using testing_support::results_of;
using testing_support::RunRequest;
using testing_support::SimulatedRun;

/// A figure of the table is met within this share of it.
constexpr double kSameShare = 0.05;

/// Root mean square over time and joints of planned less true joint position, 20 s at 0.5 m/s. Of every
/// control tick: a step lasts a whole number of 5 ms, so that slower samples show the same few phases of it.
double joint_error_rms_rad(const Json& published, const std::string& friction,
                           const std::vector<std::string>& settings) {
  RunRequest request = testing_support::walking(0.5, 1.0, 20.0);
  request.settings = settings;
  request.settings.push_back("timing.plan_rate_hz=" + published.at("plan_rate_hz").dump());
  request.settings.push_back("timing.plan_delay_s=" + published.at("plan_delay_s").dump());
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

std::vector<Json> published_rows() { return results_of("friction").at("rows").get<std::vector<Json>>(); }

TEST(PublishedFriction, HasResults) { EXPECT_FALSE(published_rows().empty()); }

class Friction : public ::testing::TestWithParam<Json> {};

TEST_P(Friction, CompensationOfFiveNewtonMetresLeavesTheJointErrorOfJointsWithout) {
  const std::vector<std::string> known = {"robot.hip_coulomb_friction_Nm=5",
                                          "robot.knee_coulomb_friction_Nm=5"};
  const double none_rad = joint_error_rms_rad(GetParam(), "joint_friction_Nm=0", {});
  const double unknown_rad = joint_error_rms_rad(GetParam(), "joint_friction_Nm=5", {});
  const double configured_rad = joint_error_rms_rad(GetParam(), "joint_friction_Nm=5", known);
  Json row = {{"plan_rate_hz", GetParam().at("plan_rate_hz")},
              {"plan_delay_s", GetParam().at("plan_delay_s")},
              {"no_friction_rad", none_rad},
              {"unknown_rad", unknown_rad},
              {"configured_rad", configured_rad},
              {"configured_over_unknown", configured_rad / unknown_rad}};
  std::printf("%s\n", row.dump().c_str());
  for (const auto& [field, value] : row.items()) {
    const double published = GetParam().at(field).get<double>();
    EXPECT_NEAR(value.get<double>(), published, kSameShare * published) << field;
  }
  if (GetParam().at("plan_rate_hz").get<double>() > 100.0) return;  // a plan is too new for friction to show
  EXPECT_LE(configured_rad, 0.6 * unknown_rad);
  EXPECT_LE(configured_rad, 1.1 * none_rad);
}

INSTANTIATE_TEST_SUITE_P(PlansPerSecond, Friction, ::testing::ValuesIn(published_rows()),
                         [](const auto& test) { return test.param.at("plan_rate_hz").dump(); });

}  // namespace
}  // namespace stilt::simulation
