#include "host_tools/simulation/plant/plant.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/host_tools/simulation/plant/test_robots.h"
#include "tests/robots.h"

namespace stilt::simulation {
namespace {

using model::JointVector;
using model::StateVector;

constexpr double kMass_kg = 21.55652;

/// Energy gained over 0.4 s of flight.
double flight_energy_error_J(double time_step_s) {
  PlantOptions options;
  options.time_step_s = time_step_s;
  Plant plant = amber_plant(options);
  plant.set_state(tumbling());
  const double before_J = plant.energy_J();
  for (int i = 0; i < std::lround(0.4 / time_step_s); ++i) plant.step();
  return plant.energy_J() - before_J;
}

TEST(Plant, FlightKeepsEnergyInTheLimitOfSmallSteps) {
  // The engine's integrator is of first order: E(h) = a h + b h^2 + ... must extrapolate to nothing at h = 0.
  const double coarse_J = flight_energy_error_J(2e-4);
  const double middle_J = flight_energy_error_J(1e-4);
  const double fine_J = flight_energy_error_J(5e-5);
  const double limit_J = (8.0 * fine_J - 6.0 * middle_J + coarse_J) / 3.0;
  EXPECT_NEAR(limit_J, 0.0, 1e-5);
  EXPECT_NEAR(middle_J / fine_J, 2.0, 0.01);
}

TEST(Plant, FreeFallAcceleratesEveryLinkAlike) {
  Plant plant = amber_plant();
  StateVector state = standing_state(kAmberLeg, 0.8, 0.15);
  state[1] = 5.0;
  plant.set_state(state);
  constexpr int kSteps = 1000;
  for (int i = 0; i < kSteps; ++i) plant.step();
  const double dt_s = plant.time_step_s();
  EXPECT_NEAR(plant.state()[1], 5.0 - 9.81 * dt_s * dt_s * kSteps * (kSteps + 1) / 2.0, 1e-9);
  EXPECT_NEAR(plant.state()[8], -9.81 * dt_s * kSteps, 1e-9);
  EXPECT_LT((plant.state() - state).segment<5>(2).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_EQ(plant.contact_force_N().norm(), 0.0);
}

TEST(Plant, StandingFeetCarryTheWeightAndPushAgainstEachOther) {
  Plant plant = amber_plant();
  const StateVector posture = standing_state(kAmberLeg, 0.8, 0.15);
  plant.set_state(posture);
  hold(plant, posture, 3.0);
  const model::FeetVector force_N = plant.contact_force_N();
  EXPECT_NEAR(force_N[1] + force_N[3], kMass_kg * 9.81, 0.05);
  EXPECT_NEAR(force_N[0] + force_N[2], 0.0, 0.05);
  EXPECT_EQ(plant.fall(), Fall::none);
}

TEST(Plant, MassScaleChangesTheWeight) {
  PlantOptions options;
  options.mass_scale = 1.2;
  Plant plant = amber_plant(options);
  EXPECT_NEAR(plant.mass_kg(), 1.2 * kMass_kg, 1e-9);
  const StateVector posture = standing_state(kAmberLeg, 0.8, 0.15);
  plant.set_state(posture);
  hold(plant, posture, 3.0);
  EXPECT_NEAR(plant.contact_force_N()[1] + plant.contact_force_N()[3], 1.2 * kMass_kg * 9.81, 0.05);
}

TEST(Plant, MassesAndInertiasScaleTogether) {
  // Without drive inertia, twice the mass under twice the torque moves alike.
  PlantOptions usual, heavy;
  usual.armature_kg_m2 = heavy.armature_kg_m2 = 0.0;
  heavy.mass_scale = 2.0;
  StateVector moved[2];
  for (const bool twice : {false, true}) {
    Plant plant = amber_plant(twice ? heavy : usual);
    plant.set_state(tumbling());
    plant.command_torque((twice ? 2.0 : 1.0) * model::JointVector(3.0, -2.0, 1.0, 2.0));
    for (int i = 0; i < 100; ++i) plant.step();
    moved[twice ? 1 : 0] = plant.state();
  }
  EXPECT_LT((moved[1] - moved[0]).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Plant, TheGroundStandsWhereItsOptionsSay) {
  PlantOptions up, down, slope, ahead;
  up.step_height_m = 0.05;
  down.step_height_m = -0.05;
  up.step_position_m = down.step_position_m = -10.0;
  slope.ground_slope_rad = 0.05;
  ahead.step_height_m = 0.03;
  ahead.step_position_m = 0.0;
  for (const PlantOptions& options : {up, down, slope, ahead}) {
    Plant plant = amber_plant(options);
    const double level_m = plant.ground_height_m(-0.15);
    StateVector posture = standing_state(kAmberLeg, 0.8, 0.15, {plant.ground_height_m(0.15) - level_m, 0.0});
    posture[1] += level_m;
    plant.set_state(posture);
    hold(plant, posture, 1.0);
    const model::FeetVector foot_m = plant.foot_position_m();
    EXPECT_GT(plant.contact_force_N()[1], 20.0);
    EXPECT_GT(plant.contact_force_N()[3], 20.0);
    EXPECT_NEAR(foot_m[1], plant.ground_height_m(foot_m[0]), 1e-3);
    EXPECT_NEAR(foot_m[3], plant.ground_height_m(foot_m[2]), 1e-3);
  }
}

TEST(Plant, ContactForcesStayInTheFrictionConeAndASlippingFootIsCounted) {
  PlantOptions options;
  options.friction = 0.05;
  Plant plant = amber_plant(options);
  const StateVector posture = standing_state(kAmberLeg, 0.8, 0.25);
  plant.set_state(posture);
  double ratio_max = 0.0;
  for (int i = 0; i < 600; ++i) {
    hold(plant, posture, plant.time_step_s());
    const model::FeetVector force_N = plant.contact_force_N();
    for (const int x : {0, 2}) {
      if (force_N[x + 1] > 1.0) ratio_max = std::max(ratio_max, std::abs(force_N[x]) / force_N[x + 1]);
    }
  }
  EXPECT_LE(ratio_max, 0.05 + 1e-6);
  EXPECT_GT(ratio_max, 0.049);
  EXPECT_GT(plant.slip_distance_m(), 0.005);
}

TEST(Plant, EachWayOfFallingIsRecognised) {
  Plant plant = amber_plant();
  StateVector state = standing_state(kAmberLeg, 0.8, 0.15);
  plant.set_state(state);
  EXPECT_EQ(plant.fall(), Fall::none);
  state[1] = 0.47;
  plant.set_state(state);
  EXPECT_EQ(plant.fall(), Fall::hip_too_low);
  state[1] = 0.8;
  state[2] = -1.1;
  plant.set_state(state);
  EXPECT_EQ(plant.fall(), Fall::pitch_too_large);
}

TEST(Plant, TheMarginToAFallIsOneUprightAndZeroWhereTheFallBegins) {
  PlantOptions slope;
  slope.ground_slope_rad = 0.1;
  Plant plant = amber_plant(), on_slope = amber_plant(slope);
  StateVector state = standing_state(kAmberLeg, 0.8, 0.15);
  const auto margin = [&](double hip_m, double pitch_rad) {
    state[1] = hip_m;
    state[2] = pitch_rad;
    plant.set_state(state);
    EXPECT_EQ(plant.fall() == Fall::none, plant.fall_margin() >= 0.0) << hip_m << " " << pitch_rad;
    return plant.fall_margin();
  };
  EXPECT_NEAR(margin(0.8, 0.0), 1.0, 1e-12);
  EXPECT_NEAR(margin(0.72, 0.0), 0.75, 1e-12) << "a quarter of the way from 0.8 m to 0.48 m";
  EXPECT_NEAR(margin(0.72, -0.4), 0.6, 1e-12) << "the pitch is nearer to its bound";
  EXPECT_NEAR(margin(0.4801, 0.0), 0.0, 1e-3);
  EXPECT_NEAR(margin(0.8, 0.999), 0.001, 1e-12);
  EXPECT_LT(margin(0.47, 0.0), 0.0);
  EXPECT_LT(margin(0.8, 1.01), 0.0);
  state[0] = 2.0;
  state[1] = 0.72 + 2.0 * std::tan(0.1);
  state[2] = 0.0;
  on_slope.set_state(state);
  EXPECT_NEAR(on_slope.fall_margin(), 0.75, 1e-9) << "heights count from the ground under the hip";
}

TEST(Plant, AKneeUnderTheGroundIsAFall) {
  PlantOptions options;
  options.step_height_m = 0.3;
  options.step_position_m = 0.2;
  Plant plant = amber_plant(options);
  StateVector state = StateVector::Zero();
  state[1] = 0.5;
  state[3] = -0.8;  // knee ahead of the hip, over the step, under its top
  plant.set_state(state);
  EXPECT_EQ(plant.fall(), Fall::body_on_ground);
}

TEST(Plant, ATorsosCentreOfMassUnderTheGroundIsAFall) {
  constexpr double kLowHip_m = 0.1;
  PlantOptions options;
  options.step_height_m = 0.3;
  options.step_position_m = 0.1;
  Plant plant(make_plant_model(robot_tree("amber3m"), options, kLowHip_m), options, 1);
  StateVector state = StateVector::Zero();
  state[1] = kLowHip_m;
  state[2] = -0.9;
  state[3] = state[5] = 2.6;  // thighs behind the hip, above the ground
  plant.set_state(state);
  EXPECT_EQ(plant.fall(), Fall::none) << "leaning backward, away from the step";
  state[2] = 0.9;
  state[3] = state[5] = 0.8;
  plant.set_state(state);
  EXPECT_EQ(plant.fall(), Fall::body_on_ground);
}

TEST(Plant, ATorqueThatIsNoNumberIsAFall) {
  Plant plant = amber_plant();
  plant.set_state(tumbling());
  plant.command_torque(JointVector::Constant(std::numeric_limits<double>::quiet_NaN()));
  for (int i = 0; i < 3; ++i) plant.step();
  EXPECT_EQ(plant.fall(), Fall::not_finite);
}

TEST(Plant, AForceOfTheSurroundingsLiftsTheWeightExactly) {
  PlantOptions options;
  Plant plant = amber_plant(options);
  StateVector floating = standing_state(kAmberLeg, 0.8, 0.15);
  floating[1] = 5.0;
  plant.set_state(floating);
  model::PositionVector lift = model::PositionVector::Zero();
  lift[1] = (kMass_kg + 1.0) * model::kGravity_m_s2;
  plant.set_surroundings_force(lift);
  plant.step();
  const StateVector state = plant.state();
  const model::RobotModel& robot = testing_support::amber3m();
  model::MassMatrixTerms<double> mass;
  robot.mass_matrix(state.data(), robot.constants.joint_parameters, mass);
  double momentum_z_Ns = 0.0;
  for (int i = 0; i < model::kPositions; ++i) {
    momentum_z_Ns += mass.mass_matrix[1][i] * state[model::kPositions + i];
  }
  EXPECT_NEAR(momentum_z_Ns, model::kGravity_m_s2 * plant.time_step_s(), 1e-5);
  plant.set_surroundings_force(model::PositionVector::Zero());
  plant.step();
  EXPECT_LT(plant.state()[model::kPositions + 1], state[model::kPositions + 1]) << "it falls again";
}

}  // namespace
}  // namespace stilt::simulation
