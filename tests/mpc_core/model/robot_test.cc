#include "mpc_core/model/robot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "mpc_core/model/batch.h"
#include "tests/mpc_core/printers.h"
#include "tests/robots.h"

namespace stilt::model {
namespace {

constexpr std::array<ContactMode, 4> kModes{{{.left = false, .right = false},
                                             {.left = true, .right = false},
                                             {.left = false, .right = true},
                                             {.left = true, .right = true}}};

TEST(Robot, Amber3mHasItsPublishedMassAndLegLength) {
  const RobotConstants& c = testing_support::amber3m().constants;
  EXPECT_NEAR(c.total_mass_kg, 13.0 + 2.0 * (3.4261 + 0.85216), 1e-9);
  EXPECT_NEAR(c.thigh_length_m + c.shin_length_m, 0.8731, 1e-9);
  EXPECT_NEAR(c.torso_com_height_m, 0.21483, 1e-9);
  for (int j = 0; j < kJoints; ++j) EXPECT_NEAR(c.joint_parameters[j], 91.4286 * 91.4286 * 5.1e-5, 1e-9);
}

TEST(Robot, Amber3m2020DiffersByTheTorsosCentreOfMassAlone) {
  RobotConstants other = testing_support::amber3m_2020().constants;
  const RobotConstants& c = testing_support::amber3m().constants;
  EXPECT_NEAR(other.torso_com_height_m, 0.28507, 1e-9);
  EXPECT_EQ(other.total_mass_kg, c.total_mass_kg);
  EXPECT_EQ(other.thigh_length_m, c.thigh_length_m);
  EXPECT_EQ(other.shin_length_m, c.shin_length_m);
  for (int j = 0; j < kJoints; ++j) {
    EXPECT_EQ(other.position_min_rad[j], c.position_min_rad[j]);
    EXPECT_EQ(other.position_max_rad[j], c.position_max_rad[j]);
    EXPECT_EQ(other.velocity_limit_rad_s[j], c.velocity_limit_rad_s[j]);
    EXPECT_EQ(other.torque_limit_Nm[j], c.torque_limit_Nm[j]);
    EXPECT_EQ(other.joint_parameters[j], c.joint_parameters[j]);
  }
}

class EveryRobot : public testing::TestWithParam<const RobotModel*> {};

TEST_P(EveryRobot, HasLimitsThatAdmitStanding) {
  const RobotConstants& c = GetParam()->constants;
  for (int j = 0; j < kJoints; ++j) {
    EXPECT_LT(c.position_min_rad[j], c.position_max_rad[j]);
    EXPECT_GT(c.velocity_limit_rad_s[j], 0.0);
    EXPECT_GT(c.torque_limit_Nm[j], 0.0);
    EXPECT_GE(c.joint_parameters[j], 0.0);
    EXPECT_GE(c.joint_parameters[kJoints + j], 0.0);
  }
}

/// Every lane of a batch gets a state of its own.
TEST_P(EveryRobot, BatchFunctionsAreTheScalarOnesLaneByLane) {
  constexpr std::uint64_t kSeed = 8;
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  double x[kLanes][kStates];
  double u[kLanes][kInputs];
  for (int lane = 0; lane < kLanes; ++lane) {
    for (double& value : x[lane]) value = 2.0 * uniform(random);
    for (double& value : u[lane]) value = 50.0 * uniform(random);
  }
  Batch xs[kStates];
  Batch us[kInputs];
  Batch ps[2 * kJoints];
  for (int i = 0; i < kStates; ++i) xs[i] = Batch([&](auto lane) { return x[lane][i]; });
  for (int i = 0; i < kInputs; ++i) us[i] = Batch([&](auto lane) { return u[lane][i]; });
  const double* p = GetParam()->constants.joint_parameters;
  for (int i = 0; i < 2 * kJoints; ++i) ps[i] = Batch(p[i]);
  const RobotModel& robot = *GetParam();
  const auto same = [](const auto& batched, const auto& alone, int lane) {
    constexpr auto kEntries = sizeof(alone) / sizeof(double);
    const auto* many = reinterpret_cast<const Batch*>(&batched);
    const auto* one = reinterpret_cast<const double*>(&alone);
    for (std::size_t i = 0; i < kEntries; ++i) {
      EXPECT_NEAR(many[i][lane], one[i], 1e-11 * (1.0 + std::abs(one[i])))
          << "entry " << i << " lane " << lane;
    }
  };
  FlowTerms<Batch> flow_b;
  NodeTerms<Batch> node_b;
  KinematicsTerms<Batch> kinematics_b;
  MassMatrixTerms<Batch> mass_b;
  BiasTerms<Batch> bias_b;
  ImpactTerms<Batch> impact_b[kModes.size()];
  robot.flow(xs, us, flow_b);
  robot.node(xs, us, ps, node_b);
  robot.kinematics(xs, kinematics_b);
  robot.mass_matrix(xs, ps, mass_b);
  robot.bias(xs, bias_b);
  for (std::size_t i = 0; i < kModes.size(); ++i) robot.impact(kModes[i], xs, ps, impact_b[i]);
  for (int lane = 0; lane < kLanes; ++lane) {
    FlowTerms<double> flow;
    NodeTerms<double> node;
    KinematicsTerms<double> kinematics;
    MassMatrixTerms<double> mass;
    BiasTerms<double> bias;
    robot.flow(x[lane], u[lane], flow);
    robot.node(x[lane], u[lane], p, node);
    robot.kinematics(x[lane], kinematics);
    robot.mass_matrix(x[lane], p, mass);
    robot.bias(x[lane], bias);
    same(flow_b, flow, lane);
    same(node_b, node, lane);
    same(kinematics_b, kinematics, lane);
    same(mass_b, mass, lane);
    same(bias_b, bias, lane);
    for (std::size_t i = 0; i < kModes.size(); ++i) {
      ImpactTerms<double> impact;
      robot.impact(kModes[i], x[lane], p, impact);
      same(impact_b[i], impact, lane);
    }
  }
}

/// Which foot is which: only the landing one comes to rest.
TEST_P(EveryRobot, ImpactOfEachFootBringsThatFootToRest) {
  const double* p = GetParam()->constants.joint_parameters;
  double x[kStates] = {0.0, 0.8, 0.1, -0.4, 0.7, 0.2, 0.5, 0.6, -0.4, 0.3, 1.0, -0.7, 0.4, 0.9};
  for (int foot = 0; foot < kFeet; ++foot) {
    ImpactTerms<double> impact;
    GetParam()->impact({.left = foot == kLeft, .right = foot == kRight}, x, p, impact);
    double after[kStates];
    std::copy(x, x + kPositions, after);
    std::copy(impact.velocity_after, impact.velocity_after + kPositions, after + kPositions);
    KinematicsTerms<double> feet;
    GetParam()->kinematics(after, feet);
    EXPECT_NEAR(std::hypot(feet.foot_velocity[2 * foot], feet.foot_velocity[2 * foot + 1]), 0.0, 1e-12);
    EXPECT_GT(std::hypot(feet.foot_velocity[2 - 2 * foot], feet.foot_velocity[3 - 2 * foot]), 0.1);
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, EveryRobot,
                         testing::Values(&testing_support::amber3m(), &testing_support::amber3m_2020(),
                                         &testing_support::rabbit()),
                         [](const auto& instance) { return std::string(instance.param->constants.name); });

TEST(ContactMode, CountsAndIndexesItsFeet) {
  constexpr ContactMode kRightOnly{false, true};
  EXPECT_EQ(kRightOnly.count(), 1);
  EXPECT_FALSE(kRightOnly[kLeft]);
  EXPECT_TRUE(kRightOnly[kRight]);
  EXPECT_EQ((ContactMode{true, true}).count(), 2);
  EXPECT_EQ(ContactMode{}.count(), 0);
}

}  // namespace
}  // namespace stilt::model
