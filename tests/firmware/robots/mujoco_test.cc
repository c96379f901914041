#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "firmware/robots/robots.h"
#include "tests/codegen/model/mujoco_robot.h"

namespace stilt::robots {
namespace {

using model::kFeet;
using model::kJoints;
using model::kPositions;

constexpr unsigned kSeed = 91;
constexpr int kSamples = 200;
constexpr double kTolerance = 1e-9;

/// Largest difference relative to the largest reference value.
double relative_error(const double* values, const double* reference, int count) {
  double error = 0.0;
  double scale = 0.0;
  for (int i = 0; i < count; ++i) {
    error = std::max(error, std::abs(values[i] - reference[i]));
    scale = std::max(scale, std::abs(reference[i]));
  }
  return error / scale;
}

/// A robot by name or file: its model's numbers against the same URDF in MuJoCo.
class RobotInMujoco : public testing::TestWithParam<const char*> {};

TEST_P(RobotInMujoco, MovesAsItsModelSays) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  const auto robot = find(GetParam());
  ASSERT_TRUE(robot) << robot.error();
  const model::RobotModel& model = (*robot)->model;
  const double* p = model.constants.joint_parameters;
  testing_support::MujocoRobot oracle((*robot)->tree);
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int sample = 0; sample < kSamples; ++sample) {
    double x[model::kStates];
    double u[model::kInputs];
    for (int i = 0; i < kPositions; ++i) x[i] = 2.0 * uniform(random);
    for (int i = 0; i < kPositions; ++i) x[kPositions + i] = 8.0 * uniform(random);
    for (int i = 0; i < kJoints; ++i) u[i] = 50.0 * uniform(random);
    for (int i = kJoints; i < model::kInputs; ++i) u[i] = 300.0 * uniform(random);
    for (int j = 0; j < kJoints; ++j) oracle.set_joint(j, p[j], p[kJoints + j]);
    model::NodeTerms<double> node;
    model::MassMatrixTerms<double> mass;
    model::BiasTerms<double> bias;
    model.node(x, u, p, node);
    model.mass_matrix(x, p, mass);
    model.bias(x, bias);
    oracle.forward(x, node.joint_torque, u + kJoints);
    double acceleration[kPositions];
    std::copy_n(node.base_acceleration, 3, acceleration);
    std::copy_n(u, kJoints, acceleration + 3);
    ASSERT_LE(relative_error(acceleration, oracle.acceleration(), kPositions), kTolerance) << sample;
    ASSERT_LE(relative_error(bias.bias, oracle.bias(), kPositions), kTolerance) << sample;
    ASSERT_LE(relative_error(mass.mass_matrix[0], oracle.mass_matrix().data(), kPositions * kPositions),
              kTolerance)
        << sample;
    for (int foot = 0; foot < kFeet; ++foot) {
      ASSERT_LE(relative_error(node.foot_position + 2 * foot, oracle.foot_position(foot).data(), 2),
                kTolerance);
      ASSERT_LE(relative_error(node.foot_acceleration + 2 * foot, oracle.foot_acceleration(foot).data(), 2),
                kTolerance);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, RobotInMujoco,
                         testing::Values("amber3m", "amber3m_2020", "rabbit",
                                         STILT_TEST_DATA "/robots/heavy.urdf"),
                         [](const auto& instance) {
                           const std::string name = instance.param;
                           return is_file(name) ? std::string("heavy_file") : name;
                         });

}  // namespace
}  // namespace stilt::robots
