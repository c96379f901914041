#include <algorithm>
#include <cmath>
#include <string>

#include "codegen/urdf/urdf_reader.h"
#include "tests/codegen/generated/robots.h"
#include "tests/codegen/model/mujoco_robot.h"

namespace stilt::testing_support {
namespace {

using model::kFeet;
using model::kJoints;
using model::kPositions;

constexpr unsigned kSeed = 61;
constexpr int kSamples = 1000;
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

template <class Robot>
class MujocoTest : public testing::Test {
 protected:
  static codegen::PlanarTree tree() {
    return codegen::read_urdf(std::string(STILT_SOURCE_DIR "/codegen/robots/") + Robot::name() + ".urdf");
  }
};
TYPED_TEST_SUITE(MujocoTest, Robots);

TYPED_TEST(MujocoTest, DynamicsAgreeWithMujocoOnAThousandRandomStates) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937_64 random(kSeed);
  MujocoRobot oracle(this->tree());
  ASSERT_EQ(oracle.size(), kPositions);
  for (int n = 0; n < kSamples; ++n) {
    SCOPED_TRACE(testing::Message() << "sample " << n);
    const Sample s(random);
    for (int j = 0; j < kJoints; ++j) oracle.set_joint(j, s.p[j], s.p[kJoints + j]);
    const auto node = TypeParam::node(s.x.data(), s.u.data(), s.p.data());
    const auto mass = TypeParam::mass_matrix(s.x.data(), s.p.data());
    const auto bias = TypeParam::bias(s.x.data());
    const auto kinematics = TypeParam::kinematics(s.x.data());
    oracle.forward(s.x.data(), node.joint_torque, s.u.data() + kJoints);

    ASSERT_LE(relative_error(mass.mass_matrix[0], oracle.mass_matrix().data(), kPositions * kPositions),
              kTolerance);
    ASSERT_LE(relative_error(bias.bias, oracle.bias(), kPositions), kTolerance);
    double acceleration[kPositions];
    std::copy_n(node.base_acceleration, 3, acceleration);
    std::copy_n(s.u.data(), kJoints, acceleration + 3);
    ASSERT_LE(relative_error(acceleration, oracle.acceleration(), kPositions), kTolerance);
    for (int foot = 0; foot < kFeet; ++foot) {
      const int r = 2 * foot;
      ASSERT_LE(
          relative_error(kinematics.foot_jacobian[r], oracle.foot_jacobian(foot).data(), 2 * kPositions),
          kTolerance);
      ASSERT_LE(relative_error(kinematics.foot_position + r, oracle.foot_position(foot).data(), 2),
                kTolerance);
      ASSERT_LE(relative_error(kinematics.foot_velocity + r, oracle.foot_velocity(foot).data(), 2),
                kTolerance);
      ASSERT_LE(relative_error(node.foot_position + r, oracle.foot_position(foot).data(), 2), kTolerance);
      ASSERT_LE(relative_error(node.foot_velocity + r, oracle.foot_velocity(foot).data(), 2), kTolerance);
      ASSERT_LE(relative_error(node.foot_acceleration + r, oracle.foot_acceleration(foot).data(), 2),
                kTolerance);
    }
  }
}

TYPED_TEST(MujocoTest, TheDefaultJointParametersAreThoseOfTheUrdf) {
  const codegen::PlanarTree robot = this->tree();
  for (int j = 0; j < kJoints; ++j) {
    const codegen::PlanarJoint& joint = robot.links[static_cast<std::size_t>(j) + 1].joint;
    EXPECT_EQ(TypeParam::joint_parameters()[j], joint.armature_kg_m2());
    EXPECT_EQ(TypeParam::joint_parameters()[kJoints + j], joint.damping_Nm_s);
  }
}

}  // namespace
}  // namespace stilt::testing_support
