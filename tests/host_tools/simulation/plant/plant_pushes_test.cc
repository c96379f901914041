#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "host_tools/simulation/closed_loop/closed_loop.h"
#include "host_tools/simulation/plant/plant.h"
#include "tests/host_tools/simulation/plant/test_robots.h"
#include "tests/robots.h"

namespace stilt::simulation {
namespace {

using model::PositionVector;
using model::StateVector;

/// Momentum along x, from the generated mass matrix: independent of the physics engine.
double momentum_x_Ns(const StateVector& state) {
  const model::RobotModel& robot = testing_support::amber3m();
  model::MassMatrixTerms<double> mass;
  robot.mass_matrix(state.data(), robot.constants.joint_parameters, mass);
  double sum = 0.0;
  for (int i = 0; i < model::kPositions; ++i) sum += mass.mass_matrix[0][i] * state[model::kPositions + i];
  return sum;
}

TEST(PlantPushes, APushGivesItsImpulseAsMomentumWhereverItActs) {
  for (const PushPoint point : {PushPoint::hip, PushPoint::torso}) {
    Plant plant = amber_plant();
    StateVector state = standing_state(kAmberLeg, 0.8, 0.15);
    state[1] = 5.0;
    plant.set_state(state);
    plant.set_push(40.0, point);
    for (int i = 0; i < 400; ++i) plant.step();
    plant.set_push(0.0, point);
    for (int i = 0; i < 200; ++i) plant.step();
    EXPECT_NEAR(momentum_x_Ns(plant.state()), 40.0 * 400 * plant.time_step_s(), 5e-3);
  }
}

TEST(PlantPushes, APushAtTheTorsoPitchesForwardAndOneAtTheHipBackward) {
  const auto pitch_after_push_rad = [](PushPoint point) {
    Plant plant = amber_plant();
    StateVector state = standing_state(kAmberLeg, 0.8, 0.0);
    state[1] = 5.0;
    plant.set_state(state);
    plant.set_push(40.0, point);
    for (int i = 0; i < 100; ++i) plant.step();
    return plant.state()[2];
  };
  EXPECT_GT(pitch_after_push_rad(PushPoint::torso), 0.0);
  EXPECT_LT(pitch_after_push_rad(PushPoint::hip), 0.0);
}

/// Generalised force that acted besides gravity over the plant's first step from rest: M (v / dt + g), with
/// the engine's own mass matrix.
PositionVector force_from_rest(const PlantModel& model, const PlantOptions& options, const StateVector& from,
                               double push_N, PushPoint point) {
  Plant plant(model, options, 1);
  plant.set_state(from);
  plant.set_push(push_N, point);
  plant.step();
  PositionVector acceleration = plant.state().tail<7>() / plant.time_step_s();
  acceleration[1] += model::kGravity_m_s2;
  PhysicsIndices index;
  const ModelPointer physics = compile_mjcf(model.mjcf, index);
  apply_options(*physics, options);
  const DataPointer data(mj_makeData(physics.get()));
  for (int i = 0; i < model::kPositions; ++i) data->qpos[i] = from[i];
  mj_forward(physics.get(), data.get());
  Eigen::Matrix<double, 7, 7, Eigen::RowMajor> mass;
  mj_fullM(physics.get(), mass.data(), data->qM);
  return mass * acceleration;
}

TEST(PlantPushes, APushAtTheTorsoActsAtOneHeightOnEveryRobotAndVariant) {
  PlantOptions low, high, heavy;
  low.torso_com_m = 0.21483;
  high.torso_com_m = 0.4;
  heavy.mass_scale = 1.3;
  StateVector state = StateVector::Zero();
  state.head<7>() << 0.3, 5.0, 0.4, -0.5, 0.7, 0.2, 0.9;
  for (const std::string robot : {"amber3m", "rabbit"}) {
    for (const PlantOptions& options : {PlantOptions(), low, high, heavy}) {
      const PlantModel model = make_plant_model(robot_tree(robot), options, kHipHeight_m);
      PositionVector expected = PositionVector::Zero();
      expected[0] = 40.0;
      EXPECT_LT((force_from_rest(model, options, state, 40.0, PushPoint::hip) - expected).norm(), 1e-7);
      expected[2] = 40.0 * 0.285 * std::cos(0.4);
      EXPECT_LT((force_from_rest(model, options, state, 40.0, PushPoint::torso) - expected).norm(), 1e-7);
    }
  }
}

TEST(PlantPushes, ARecordShowsWhereThePushActs) {
  Plant plant = amber_plant();
  RunSettings settings;
  settings.duration_s = 0.5;
  settings.leg = kAmberLeg;
  settings.initial_state = standing_state(kAmberLeg, kHipHeight_m, 0.15);
  settings.pushes = {{5.0, 0.1, 0.1, PushPoint::torso}, {-6.0, 0.3, 0.1, PushPoint::hip}};
  const log::RunRecord record = run_closed_loop(plant, *amber_controller(), settings);
  ASSERT_EQ(record.samples.size(), 100u);
  EXPECT_EQ(record.samples[10].push_N, 0.0);
  EXPECT_EQ(record.samples[10].push_above_hip_m, 0.0);
  EXPECT_EQ(record.samples[30].push_N, 5.0);
  EXPECT_EQ(record.samples[30].push_above_hip_m, 0.285);
  EXPECT_EQ(record.samples[70].push_N, -6.0);
  EXPECT_EQ(record.samples[70].push_above_hip_m, 0.0);
}

}  // namespace
}  // namespace stilt::simulation
