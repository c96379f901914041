#include "host_tools/simulation/plant/stance.h"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

#include "mpc_core/model/robot.h"
#include "tests/host_tools/simulation/plant/test_robots.h"
#include "tests/robots.h"

namespace stilt::simulation {
namespace {

TEST(Stance, LegAnglesPlaceTheFootWhereAskedWithTheKneeBentForward) {
  constexpr unsigned kSeed = 7;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> forward_m(-0.3, 0.3), below_m(0.4, 0.8), pitch_rad(-0.5, 0.5);
  for (int i = 0; i < 1000; ++i) {
    model::StateVector state = model::StateVector::Zero();
    const double x = forward_m(random), z = below_m(random);
    state[2] = pitch_rad(random);
    const LegAngles leg = leg_angles(kAmberLeg, x, z, state[2]);
    state[5] = leg.hip_rad;
    state[6] = leg.knee_rad;
    model::KinematicsTerms<double> feet;
    testing_support::amber3m().kinematics(state.data(), feet);
    EXPECT_NEAR(feet.foot_position[2], x, 1e-12);
    EXPECT_NEAR(feet.foot_position[3], -z, 1e-12);
    EXPECT_GE(leg.knee_rad, 0.0);
  }
}

TEST(Stance, StandingPutsTheLeftFootAheadAndBothOnTheirGround) {
  const model::StateVector state = standing_state(kAmberLeg, 0.8, 0.15, {0.01, -0.02});
  model::KinematicsTerms<double> feet;
  testing_support::amber3m().kinematics(state.data(), feet);
  EXPECT_NEAR(feet.foot_position[0], 0.15, 1e-12);
  EXPECT_NEAR(feet.foot_position[1], 0.01, 1e-12);
  EXPECT_NEAR(feet.foot_position[2], -0.15, 1e-12);
  EXPECT_NEAR(feet.foot_position[3], -0.02, 1e-12);
  EXPECT_EQ(state[2], 0.0);
}

TEST(Stance, AFootOutOfReachIsRefused) {
  EXPECT_THROW((void)leg_angles(kAmberLeg, 0.0, 0.9, 0.0), std::invalid_argument);
  EXPECT_THROW((void)leg_angles(kAmberLeg, 0.01, 0.0, 0.0), std::invalid_argument);
}

TEST(Stance, FootPositionsAgreeWithTheGeneratedKinematics) {
  model::StateVector state;
  state << 0.3, 0.75, 0.2, -0.4, 0.6, 0.1, 0.9, 0, 0, 0, 0, 0, 0, 0;
  model::KinematicsTerms<double> feet;
  testing_support::amber3m().kinematics(state.data(), feet);
  const model::FeetVector positions_m = foot_positions(kAmberLeg, state);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(positions_m[i], feet.foot_position[i], 1e-12);
}

}  // namespace
}  // namespace stilt::simulation
