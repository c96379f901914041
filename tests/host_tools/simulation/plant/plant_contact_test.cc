#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "host_tools/simulation/plant/plant.h"
#include "tests/host_tools/simulation/plant/test_robots.h"

namespace stilt::simulation {
namespace {

using model::StateVector;

/// The plant's contact on MuJoCo's side.
struct EngineContact {
  explicit EngineContact(const PlantOptions& options) {
    PhysicsIndices index;
    physics = compile_mjcf(make_plant_model(robot_tree("amber3m"), options, kHipHeight_m).mjcf, index);
    data.reset(mj_makeData(physics.get()));
    data->qpos[1] = 0.87;  // straight legs, 3 mm into the ground
    mj_forward(physics.get(), data.get());
  }
  ModelPointer physics;
  DataPointer data;
};

/// Mean height of both feet, standing.
double standing_foot_height_m(double time_constant_s, double damping_ratio) {
  PlantOptions options;
  options.contact_time_constant_s = time_constant_s;
  options.contact_damping_ratio = damping_ratio;
  Plant plant = amber_plant(options);
  const StateVector posture = standing_state(kAmberLeg, kHipHeight_m, 0.15);
  plant.set_state(posture);
  hold(plant, posture, 2.0);
  return 0.5 * (plant.foot_position_m()[1] + plant.foot_position_m()[3]);
}

TEST(PlantContact, StiffnessAndDampingOfTheOptionsAreThoseOfTheEnginesContacts) {
  PlantOptions soft;
  soft.contact_time_constant_s = 0.013;
  soft.contact_damping_ratio = 0.7;
  const EngineContact changed(soft), usual({});
  ASSERT_EQ(changed.data->ncon, 2);
  ASSERT_EQ(usual.data->ncon, 2);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(changed.data->contact[i].solref[0], 0.013);
    EXPECT_EQ(changed.data->contact[i].solref[1], 0.7);
    EXPECT_EQ(usual.data->contact[i].solref[0], 0.004);
    EXPECT_EQ(usual.data->contact[i].solref[1], 1.0);
  }
}

TEST(PlantContact, AContactStifferThanThePhysicsStepCarriesIsRefused) {
  PlantOptions options;
  options.contact_time_constant_s = 0.0009;
  EXPECT_THROW((void)amber_plant(options), std::invalid_argument);
  options.contact_time_constant_s = 0.001;
  EXPECT_NO_THROW((void)amber_plant(options));
  options.time_step_s = 0.0001;
  options.contact_time_constant_s = 0.0002;
  EXPECT_NO_THROW((void)amber_plant(options));
}

TEST(PlantContact, ALoadedFootSinksInWithTheSquareOfTimeConstantAndDampingRatio) {
  // MuJoCo documents r k d / (1 - d) = A f with k proportional to 1 / (time constant * damping ratio)^2. At
  // one load the depth r goes with the square of both, less 1 % here because the impedance d grows with the
  // depth.
  const double usual_m = standing_foot_height_m(0.004, 1.0);
  const double softer_m = standing_foot_height_m(0.006, 1.0), softest_m = standing_foot_height_m(0.008, 1.0);
  const double expected_ratio = (4.0 - 1.0) / (2.25 - 1.0);
  EXPECT_NEAR((usual_m - softest_m) / (usual_m - softer_m), expected_ratio, 0.02 * expected_ratio);
  EXPECT_NEAR(usual_m - standing_foot_height_m(0.004, 2.0), usual_m - softest_m,
              0.02 * (usual_m - softest_m));
}

TEST(PlantContact, ATorsosCentreOfMassMovesWithoutItsMassAndInertia) {
  PlantOptions low;
  low.torso_com_m = 0.123;
  const EngineContact changed(low), usual({});
  const int torso = changed.physics->jnt_bodyid[model::kFirstAngle];
  EXPECT_NE(usual.physics->body_ipos[3 * torso + 2], 0.123);
  for (int body = 0; body < usual.physics->nbody; ++body) {
    EXPECT_EQ(changed.physics->body_mass[body], usual.physics->body_mass[body]);
    for (int axis = 0; axis < 3; ++axis) {
      const int i = 3 * body + axis;
      EXPECT_EQ(changed.physics->body_inertia[i], usual.physics->body_inertia[i]);
      const double expected_m = i == 3 * torso + 2 ? 0.123 : usual.physics->body_ipos[i];
      EXPECT_EQ(changed.physics->body_ipos[i], expected_m);
    }
  }
  Plant plant = amber_plant(low);
  plant.set_state(StateVector::Zero());
  EXPECT_NEAR(plant.torso_com_m().y(), 0.123, 1e-15);
}

TEST(PlantContact, TheEnginesConstantsFollowTheMassesOfTheOptions) {
  EngineContact changed({});
  PlantOptions heavy;
  heavy.mass_scale = 2.0;
  const double mass_kg = changed.physics->body_subtreemass[0];
  const double inverse_kg = changed.physics->body_invweight0[2 * 1];
  apply_options(*changed.physics, heavy);
  EXPECT_NEAR(changed.physics->body_subtreemass[0], 2.0 * mass_kg, 1e-9);
  EXPECT_NEAR(changed.physics->body_invweight0[2 * 1], 0.5 * inverse_kg, 0.2 * inverse_kg);
}

TEST(PlantContact, AFootThatLandsOrLiftsOffMovingForwardHasNotSlipped) {
  Plant plant = amber_plant();
  StateVector state = standing_state(kAmberLeg, kHipHeight_m, 0.15);
  const StateVector posture = state;
  state[1] += 1e-4;
  state[model::kPositions] = 1.0;
  state[model::kPositions + 1] = -0.5;
  plant.set_state(state);
  while (plant.contact_force_N().maxCoeff() < 5.0) hold(plant, posture, plant.time_step_s());
  EXPECT_GT(plant.state()[7], 0.1) << "it still moves forward";
  EXPECT_EQ(plant.slip_distance_m(), 0.0);

  plant.set_state(posture);
  hold(plant, posture, 0.5);
  const double before_m = plant.slip_distance_m();
  model::PositionVector throw_N = model::PositionVector::Zero();
  throw_N[0] = 2000.0;
  throw_N[1] = 20000.0;
  plant.set_surroundings_force(throw_N);
  hold(plant, posture, plant.time_step_s());
  ASSERT_LT(plant.contact_force_N().maxCoeff(), 5.0);
  EXPECT_EQ(plant.slip_distance_m(), before_m);
}

}  // namespace
}  // namespace stilt::simulation
