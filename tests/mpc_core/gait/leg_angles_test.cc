#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mpc_core/gait/reference.h"
#include "tests/robots.h"

namespace stilt::gait {
namespace {

using model::kLeft;
using model::kRight;

/// Feet of a state, world frame.
model::FeetVector feet(const model::RobotModel& robot, const model::StateVector& state) {
  model::KinematicsTerms<double> terms;
  robot.kinematics(state.data(), terms);
  return model::FeetVector(terms.foot_position);
}

class LegAngles : public testing::TestWithParam<const model::RobotModel*> {};

TEST_P(LegAngles, PutTheFootWhereTheKinematicsFindsIt) {
  constexpr std::uint64_t kSeed = 5;
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const model::RobotConstants& c = GetParam()->constants;
  const double length_m = c.thigh_length_m + c.shin_length_m;
  for (int sample = 0; sample < 1000; ++sample) {
    const double reach_m = length_m * (0.65 + 0.345 * uniform(random));
    const double angle = 1.2 * uniform(random);
    const double x_m = reach_m * std::sin(angle);
    const double z_m = -reach_m * std::cos(angle);
    const Eigen::Vector2d angles = leg_angles(x_m, z_m, c.thigh_length_m, c.shin_length_m);
    EXPECT_GE(angles[1], 0.0) << "knees bend to positive angles";
    model::StateVector state = model::StateVector::Zero();
    state.segment<2>(3) = angles;
    state.segment<2>(5) = angles;
    const model::FeetVector found = feet(*GetParam(), state);
    for (const int foot : {kLeft, kRight}) {
      ASSERT_NEAR(found[2 * foot], x_m, 1e-9) << "seed " << kSeed << " sample " << sample;
      ASSERT_NEAR(found[2 * foot + 1], z_m, 1e-9) << "seed " << kSeed << " sample " << sample;
    }
  }
}

TEST_P(LegAngles, OutOfReachGiveTheStraightLegTowardsThePoint) {
  const model::RobotConstants& c = GetParam()->constants;
  const double length_m = c.thigh_length_m + c.shin_length_m;
  const Eigen::Vector2d angles = leg_angles(0.6, -1.2, c.thigh_length_m, c.shin_length_m);
  EXPECT_NEAR(angles[1], 0.0, 1e-3);
  model::StateVector state = model::StateVector::Zero();
  state.segment<2>(3) = angles;
  const model::FeetVector found = feet(*GetParam(), state);
  EXPECT_NEAR(found[0] / found[1], 0.6 / -1.2, 1e-6);
  EXPECT_NEAR(std::hypot(found[0], found[1]), length_m, 1e-6);
}

TEST_P(LegAngles, TooCloseStayFinite) {
  const model::RobotConstants& c = GetParam()->constants;
  EXPECT_TRUE(leg_angles(1e-3, -1e-3, c.thigh_length_m, c.shin_length_m).allFinite());
}

TEST_P(LegAngles, StandingStatePutsTheFeetEitherSideOfTheHipAtAnyPitch) {
  for (const double pitch_rad : {-0.3, 0.0, 0.2}) {
    for (const bool left_ahead : {true, false}) {
      const double height_m =
          0.9 * (GetParam()->constants.thigh_length_m + GetParam()->constants.shin_length_m);
      const model::StateVector state =
          standing_state(GetParam()->constants, height_m, pitch_rad, 0.12, left_ahead);
      const model::FeetVector found = feet(*GetParam(), state);
      const double left_x_m = left_ahead ? 0.12 : -0.12;
      EXPECT_NEAR(found[0], left_x_m, 1e-9);
      EXPECT_NEAR(found[1], 0.0, 1e-9);
      EXPECT_NEAR(found[2], -left_x_m, 1e-9);
      EXPECT_NEAR(found[3], 0.0, 1e-9);
      EXPECT_EQ(state[1], height_m);
      EXPECT_EQ(state[2], pitch_rad);
      EXPECT_EQ(state.tail<model::kPositions>().norm(), 0.0);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, LegAngles,
                         testing::Values(&testing_support::amber3m(), &testing_support::rabbit()),
                         [](const auto& instance) { return std::string(instance.param->constants.name); });

}  // namespace
}  // namespace stilt::gait
