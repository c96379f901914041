#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "host_tools/simulation/plant/plant.h"
#include "tests/host_tools/simulation/plant/test_robots.h"

namespace stilt::simulation {
namespace {

using model::JointVector;
using model::StateVector;

constexpr int kKneeL = 1;

/// In the air, at rest.
StateVector floating() {
  StateVector state = standing_state(kAmberLeg, kHipHeight_m, 0.15);
  state[1] = 5.0;
  return state;
}

/// Speed of the left knee after a constant torque in the air. With this armature the shin's own inertia, at
/// most 0.0445 kg m^2 about the knee, counts for less than half a per cent.
constexpr double kHeavyArmature_kg_m2 = 10.0;
double knee_speed_rad_s(PlantOptions options, double torque_Nm, double duration_s) {
  options.armature_kg_m2 = kHeavyArmature_kg_m2;
  Plant plant = amber_plant(options);
  plant.set_state(floating());
  JointVector command_Nm = JointVector::Zero();
  command_Nm[kKneeL] = torque_Nm;
  plant.command_torque(command_Nm);
  for (int i = 0; i < std::lround(duration_s / plant.time_step_s()); ++i) plant.step();
  return plant.state().tail<4>()[kKneeL];
}

TEST(PlantDrives, TorqueSaturatesAtTheLimitOfTheUrdfOrOfTheOption) {
  PlantOptions weak;
  weak.torque_limit_Nm = 30.0;
  Plant strong_plant = amber_plant(), weak_plant = amber_plant(weak);
  for (Plant* plant : {&strong_plant, &weak_plant}) {
    plant->set_state(tumbling());
    plant->command_torque(JointVector(500.0, -500.0, 10.0, -10.0));
    plant->step();
  }
  EXPECT_EQ(strong_plant.applied_torque_Nm(), JointVector(80.0, -80.0, 10.0, -10.0));
  EXPECT_EQ(weak_plant.applied_torque_Nm(), JointVector(30.0, -30.0, 10.0, -10.0));
}

TEST(PlantDrives, TorqueActsAfterTheDelay) {
  PlantOptions options;
  options.delay_s = 0.003;
  Plant plant = amber_plant(options);
  plant.set_state(tumbling());
  plant.command_torque(JointVector::Constant(1.0));
  plant.step();
  plant.command_torque(JointVector::Constant(2.0));
  for (int i = 0; i < 6; ++i) {
    plant.step();
    EXPECT_EQ(plant.applied_torque_Nm()[0], 1.0) << "step " << i;
  }
  plant.step();
  EXPECT_EQ(plant.applied_torque_Nm()[0], 2.0);
}

TEST(PlantDrives, ArmatureOfTheOptionReplacesThatOfTheUrdf) {
  const auto hip_speed_rad_s = [](double armature_kg_m2) {
    PlantOptions options;
    options.armature_kg_m2 = armature_kg_m2;
    Plant plant = amber_plant(options);
    StateVector state = standing_state(kAmberLeg, 0.8, 0.15);
    state[1] = 5.0;
    plant.set_state(state);
    plant.command_torque(JointVector(5.0, 0.0, 0.0, 0.0));
    plant.step();
    return plant.state()[10];
  };
  Plant published = amber_plant();
  EXPECT_GT(hip_speed_rad_s(0.0), 1.5 * hip_speed_rad_s(0.426319));
}

TEST(PlantDrives, NothingOfTheRunBeforeActsInTheNext) {
  PlantOptions options;
  options.delay_s = 0.003;
  options.drive_time_constant_s = 0.002;
  Plant plant = amber_plant(options);
  const auto run = [&plant](double torque_Nm) {
    plant.set_state(tumbling());
    plant.command_torque(JointVector::Constant(torque_Nm));
    std::vector<JointVector> applied_Nm = {plant.applied_torque_Nm()};
    for (int i = 0; i < 10; ++i) {  // not a multiple of the delay's six steps
      plant.step();
      applied_Nm.push_back(plant.applied_torque_Nm());
    }
    return applied_Nm;
  };
  const std::vector<JointVector> first_Nm = run(7.0);
  (void)run(500.0);
  EXPECT_TRUE(plant.saturated());
  EXPECT_EQ(run(7.0), first_Nm);
  plant.command_torque(JointVector::Constant(500.0));
  for (int i = 0; i < 8; ++i) plant.step();
  plant.set_state(tumbling());
  EXPECT_FALSE(plant.saturated());
  plant.step();
  EXPECT_EQ(plant.applied_torque_Nm(), JointVector::Zero()) << "nothing has been commanded in this run";
}

TEST(PlantDrives, ATorqueFollowsItsCommandByAnExponentialAfterTheDelayWhateverTheTimeStep) {
  for (const double time_step_s : {5e-4, 1e-4}) {
    PlantOptions options;
    options.time_step_s = time_step_s;
    options.delay_s = 0.003;
    options.drive_time_constant_s = 0.005;
    Plant plant = amber_plant(options);
    plant.set_state(tumbling());
    plant.command_torque(JointVector::Constant(-20.0));
    plant.step();
    EXPECT_EQ(plant.applied_torque_Nm(), JointVector::Constant(-20.0)) << "a run starts settled";
    plant.command_torque(JointVector::Constant(30.0));
    for (int step = 1; step <= std::lround(0.02 / time_step_s); ++step) {
      plant.step();
      const double elapsed_s = std::max(0.0, step * time_step_s - 0.003);
      const double expected_Nm = 30.0 - 50.0 * std::exp(-elapsed_s / 0.005);
      ASSERT_NEAR(plant.applied_torque_Nm()[2], expected_Nm, 1e-11) << step;
    }
  }
}

TEST(PlantDrives, ADriveWithALagWindsNothingUpBeyondItsLimit) {
  PlantOptions options;
  options.drive_time_constant_s = 0.005;
  options.torque_limit_Nm = 30.0;
  Plant plant = amber_plant(options);
  plant.set_state(tumbling());
  plant.command_torque(JointVector::Zero());
  plant.step();
  EXPECT_FALSE(plant.saturated());
  plant.command_torque(JointVector::Constant(500.0));
  for (int i = 0; i < 10; ++i) plant.step();
  EXPECT_TRUE(plant.saturated());
  const double reached_Nm = 30.0 * (1.0 - std::exp(-1.0));
  EXPECT_NEAR(plant.applied_torque_Nm()[0], reached_Nm, 1e-11);
  plant.command_torque(JointVector::Zero());
  plant.step();
  EXPECT_FALSE(plant.saturated());
  EXPECT_NEAR(plant.applied_torque_Nm()[0], reached_Nm * std::exp(-0.1), 1e-11);
}

TEST(PlantDrives, ATorqueThatDrivesFallsToNothingAtTheNoLoadSpeedAndOneThatBrakesStays) {
  PlantOptions options;
  options.no_load_speed_rad_s = 4.0;
  Plant plant = amber_plant(options);
  plant.set_state(tumbling());  // joints at -1, 2, 1.5, -0.5 rad/s
  plant.command_torque(JointVector(500.0, 500.0, -500.0, -500.0));
  plant.step();
  EXPECT_LT((plant.applied_torque_Nm() - JointVector(80.0, 40.0, -80.0, -70.0)).cwiseAbs().maxCoeff(), 1e-12);
  options.no_load_speed_rad_s = 1.9;
  Plant slow = amber_plant(options);
  slow.set_state(tumbling());
  slow.command_torque(JointVector(1.0, 1.0, 1.0, 1.0));
  slow.step();
  EXPECT_EQ(slow.applied_torque_Nm(), JointVector(1.0, 0.0, 1.0, 1.0));
}

TEST(PlantDrives, AMotorIsSaturatedAtTheLimitOfItsSpeed) {
  PlantOptions options;
  options.no_load_speed_rad_s = 4.0;
  for (const auto& [knee_Nm, saturated] :
       {std::pair(39.9, false), std::pair(40.0, true), std::pair(60.0, true), std::pair(-79.9, false),
        std::pair(-80.0, true)}) {
    Plant plant = amber_plant(options);
    plant.set_state(tumbling());
    plant.command_torque(JointVector(0.0, knee_Nm, 0.0, 0.0));  // the knee turns at 2 rad/s
    plant.step();
    EXPECT_EQ(plant.saturated(), saturated) << knee_Nm;
  }
}

TEST(PlantDrives, TheTorqueOfALaggingDriveFallsAtOnceWithTheLimitOfItsSpeed) {
  PlantOptions options;
  options.no_load_speed_rad_s = 4.0;
  options.drive_time_constant_s = 0.1;
  Plant plant = amber_plant(options);
  plant.set_state(floating());
  plant.command_torque(JointVector(0.0, 80.0, 0.0, 0.0));
  for (int i = 0; i < 100; ++i) {
    const double speed_rad_s = plant.state().tail<4>()[kKneeL];
    plant.step();
    ASSERT_LE(plant.applied_torque_Nm()[kKneeL], 80.0 * (1.0 - speed_rad_s / 4.0) + 1e-12) << i;
  }
  EXPECT_GT(plant.state().tail<4>()[kKneeL], 2.0);
}

TEST(PlantDrives, AMotorOnItsTorqueSpeedLineRunsUpExponentiallyToItsNoLoadSpeed) {
  PlantOptions options;
  options.no_load_speed_rad_s = 2.0;
  const double time_constant_s = kHeavyArmature_kg_m2 * 2.0 / 80.0;
  for (const double duration_s : {0.05, 0.2, 0.5}) {
    const double expected_rad_s = 2.0 * (1.0 - std::exp(-duration_s / time_constant_s));
    EXPECT_NEAR(knee_speed_rad_s(options, 100.0, duration_s), expected_rad_s, 0.006 * expected_rad_s);
  }
}

TEST(PlantDrives, CoulombFrictionHoldsAJointBelowItAndTakesItsPartOfMoreTorque) {
  PlantOptions options;
  options.joint_friction_Nm = 5.0;
  for (const double sign : {1.0, -1.0}) {
    EXPECT_NEAR(knee_speed_rad_s(options, 4.9 * sign, 0.3), 0.0, 0.01);
    const double expected_rad_s = sign * (12.0 - 5.0) * 0.3 / kHeavyArmature_kg_m2;
    EXPECT_NEAR(knee_speed_rad_s(options, 12.0 * sign, 0.3), expected_rad_s, 0.01 * std::abs(expected_rad_s));
  }
}

TEST(PlantDrives, ViscousFrictionEndsARunUpAtTheTorqueOverTheDamping) {
  PlantOptions options;
  options.joint_damping_Nms_rad = 20.0;
  const double time_constant_s = kHeavyArmature_kg_m2 / 20.0;
  for (const double duration_s : {0.1, 0.5}) {
    const double expected_rad_s = 30.0 / 20.0 * (1.0 - std::exp(-duration_s / time_constant_s));
    EXPECT_NEAR(knee_speed_rad_s(options, 30.0, duration_s), expected_rad_s, 0.02 * expected_rad_s);
  }
}

TEST(PlantDrives, AJointEndsAtItsStopOnlyWhenStopsAreAskedFor) {
  PlantOptions stops;
  stops.joint_stops = true;
  Plant free = amber_plant(), stopped = amber_plant(stops);
  const codegen::PlanarJoint& knee = robot_tree("amber3m").links[kKneeL + 1].joint;
  for (const double sign : {1.0, -1.0}) {
    double free_range_rad = 0.0, stopped_beyond_rad = 0.0;
    for (Plant* plant : {&free, &stopped}) {
      plant->set_state(floating());
      plant->command_torque(JointVector(0.0, 10.0 * sign, 0.0, 0.0));
      for (int i = 0; i < 1000; ++i) {
        plant->step();
        const double angle_rad = plant->state()[model::kFirstJoint + kKneeL];
        const double beyond_rad =
            std::max(angle_rad - knee.position_max_rad, knee.position_min_rad - angle_rad);
        double& furthest_rad = plant == &free ? free_range_rad : stopped_beyond_rad;
        furthest_rad = std::max(furthest_rad, beyond_rad);
      }
    }
    EXPECT_GT(free_range_rad, 0.5);
    EXPECT_LT(stopped_beyond_rad, 0.1);
    EXPECT_GT(stopped_beyond_rad, 0.0) << "it came to the stop";
  }
}

}  // namespace
}  // namespace stilt::simulation
