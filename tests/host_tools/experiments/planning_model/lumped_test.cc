#include "host_tools/experiments/planning_model/lumped.h"

#include <gtest/gtest.h>

#include "tests/robots.h"

namespace stilt::planning_model {
namespace {

using enum model::Number;
using model::RobotModel;

/// The robot at zero angles as one rigid body, from the generated mass matrix without drives. The velocities
/// of the base alone move it as one.
struct RigidBody {
  double mass_kg;
  double com_z_m;
  double inertia_kg_m2;  ///< about the centre of mass
};

RigidBody frozen(const RobotModel& robot) {
  const double x[model::kStates] = {};
  const double p[2 * model::kJoints] = {};
  model::MassMatrixTerms<double> mass;
  robot.mass_matrix(x, p, mass);
  const double mass_kg = mass.mass_matrix[0][0];
  const double com_z_m = mass.mass_matrix[0][2] / mass_kg;
  return {mass_kg, com_z_m, mass.mass_matrix[2][2] - mass_kg * com_z_m * com_z_m};
}

class Lumped : public testing::TestWithParam<const RobotModel*> {};

TEST_P(Lumped, TheStraightRobotIsTheSameRigidBody) {
  const RigidBody whole = frozen(*GetParam());
  const RigidBody lump = frozen(lumped(*GetParam(), Lump::legs));
  EXPECT_NEAR(lump.mass_kg, whole.mass_kg, 1e-12 * whole.mass_kg);
  EXPECT_NEAR(lump.com_z_m, whole.com_z_m, 1e-12);
  EXPECT_NEAR(lump.inertia_kg_m2, whole.inertia_kg_m2, 1e-12 * whole.inertia_kg_m2);
}

TEST_P(Lumped, TheLegsKeepAThousandthOfTheirMassAndTheirLengths) {
  const model::RobotConstants& whole = GetParam()->constants;
  const model::RobotConstants& lump = lumped(*GetParam(), Lump::legs).constants;
  for (const model::Number number : {thigh_mass_kg, thigh_inertia_kg_m2, shin_mass_kg, shin_inertia_kg_m2}) {
    EXPECT_DOUBLE_EQ(lump.numbers[number], 0.001 * whole.numbers[number]);
  }
  for (const model::Number number : {thigh_com_m, thigh_length_m, shin_com_m, shin_length_m}) {
    EXPECT_EQ(lump.numbers[number], whole.numbers[number]);
  }
  EXPECT_NEAR(lump.total_mass_kg, whole.total_mass_kg, 1e-12 * whole.total_mass_kg);
}

TEST_P(Lumped, OnlyWithoutDrivesTheJointsReflectNoInertia) {
  const model::RobotConstants& whole = GetParam()->constants;
  for (int j = 0; j < model::kJoints; ++j) {
    EXPECT_EQ(lumped(*GetParam(), Lump::legs).constants.joint_parameters[j], whole.joint_parameters[j]);
    EXPECT_EQ(lumped(*GetParam(), Lump::drives).constants.joint_parameters[j], 0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, Lumped,
                         testing::Values(&testing_support::amber3m(), &testing_support::rabbit()),
                         [](const auto& instance) { return std::string(instance.param->constants.name); });

/// The numbers that were published as a description of their own before they were derived.
TEST(LumpedAmber3m, HasTheTorsoOfItsEarlierDescription) {
  const double* numbers = lumped(testing_support::amber3m(), Lump::legs).constants.numbers;
  EXPECT_NEAR(numbers[torso_mass_kg], 21.547963480, 1e-9);
  EXPECT_NEAR(numbers[torso_com_m], 0.036453465, 1e-9);
  EXPECT_NEAR(numbers[torso_inertia_kg_m2], 1.603764949, 1e-9);
}

}  // namespace
}  // namespace stilt::planning_model
