#include <cmath>

#include "tests/codegen/generated/robots.h"

namespace stilt::testing_support {
namespace {

using model::kFeet;
using model::kJoints;
using model::kPositions;
using model::kStates;
using Complex = std::complex<double>;

constexpr unsigned kSeed = 31;
constexpr int kSamples = 1000;

template <class Robot>
class PhysicsTest : public testing::Test {};
TYPED_TEST_SUITE(PhysicsTest, Robots);

template <class Robot, class T>
T kinetic_energy(const T* x, const T* p) {
  const model::MassMatrixTerms<T> m = Robot::mass_matrix(x, p);
  T sum(0.0);
  for (int i = 0; i < kPositions; ++i) {
    for (int j = 0; j < kPositions; ++j)
      sum += 0.5 * x[kPositions + i] * m.mass_matrix[i][j] * x[kPositions + j];
  }
  return sum;
}

/// Rate of the kinetic energy along the motion with acceleration a, by complex step.
template <class Robot>
double kinetic_power(const Sample& sample, const double* acceleration) {
  constexpr double kStep = 1e-30;
  Complex x[kStates];
  Complex p[2 * kJoints];
  for (int i = 0; i < kPositions; ++i) {
    x[i] = {sample.x[i], kStep * sample.x[kPositions + i]};
    x[kPositions + i] = {sample.x[kPositions + i], kStep * acceleration[i]};
  }
  for (int i = 0; i < 2 * kJoints; ++i) p[i] = sample.p[i];
  return kinetic_energy<Robot, Complex>(x, p).imag() / kStep;
}

TYPED_TEST(PhysicsTest, PowerOfMotorsContactsGravityAndDampingIsTheRateOfKineticEnergy) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937_64 random(kSeed);
  for (int n = 0; n < kSamples; ++n) {
    const Sample s(random);
    const model::NodeTerms<double> node = TypeParam::node(s.x.data(), s.u.data(), s.p.data());
    std::array<double, kStates> at_rest = s.x;
    for (int i = kPositions; i < kStates; ++i) at_rest[i] = 0.0;
    const model::BiasTerms<double> gravity = TypeParam::bias(at_rest.data());
    double power = 0.0;
    double scale = 0.0;
    const auto add = [&](double term) {
      power += term;
      scale += std::abs(term);
    };
    for (int i = 0; i < kPositions; ++i) add(-gravity.bias[i] * s.x[kPositions + i]);
    for (int r = 0; r < 2 * kFeet; ++r) add(s.u[kJoints + r] * node.foot_velocity[r]);
    double acceleration[kPositions];
    for (int i = 0; i < 3; ++i) acceleration[i] = node.base_acceleration[i];
    for (int j = 0; j < kJoints; ++j) {
      const double rate = s.x[kPositions + 3 + j];
      acceleration[3 + j] = s.u[j];
      add((node.joint_torque[j] - s.p[kJoints + j] * rate) * rate);
    }
    ASSERT_NEAR(kinetic_power<TypeParam>(s, acceleration), power, 1e-11 * scale) << "sample " << n;
  }
}

TYPED_TEST(PhysicsTest, AnImpactBringsTheFeetToRestAndNeverAddsEnergy) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937_64 random(kSeed);
  for (int n = 0; n < kSamples; ++n) {
    const Sample s(random);
    for (const model::ContactMode contact : kLandings) {
      const model::ImpactTerms<double> impact = TypeParam::impact(contact, s.x.data(), s.p.data());
      std::array<double, kStates> after = s.x;
      for (int i = 0; i < kPositions; ++i) after[kPositions + i] = impact.velocity_after[i];
      const model::KinematicsTerms<double> kinematics = TypeParam::kinematics(after.data());
      for (int foot = 0; foot < kFeet; ++foot) {
        if (!contact[foot]) continue;
        EXPECT_NEAR(kinematics.foot_velocity[2 * foot], 0.0, 1e-10) << "sample " << n;
        EXPECT_NEAR(kinematics.foot_velocity[2 * foot + 1], 0.0, 1e-10) << "sample " << n;
      }
      const double energy_before = kinetic_energy<TypeParam>(s.x.data(), s.p.data());
      const double energy_after = kinetic_energy<TypeParam>(after.data(), s.p.data());
      ASSERT_LE(energy_after, energy_before * (1.0 + 1e-12)) << "sample " << n;
    }
  }
}

TYPED_TEST(PhysicsTest, AnImpactChangesMomentumByItsImpulseAlone) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937_64 random(kSeed);
  for (int n = 0; n < kSamples; ++n) {
    const Sample s(random);
    const model::MassMatrixTerms<double> m = TypeParam::mass_matrix(s.x.data(), s.p.data());
    const model::KinematicsTerms<double> kinematics = TypeParam::kinematics(s.x.data());
    for (const model::ContactMode contact : kLandings) {
      const model::ImpactTerms<double> impact = TypeParam::impact(contact, s.x.data(), s.p.data());
      for (int i = 0; i < kPositions; ++i) {
        double change = 0.0;
        for (int j = 0; j < kPositions; ++j) {
          change += m.mass_matrix[i][j] * (impact.velocity_after[j] - s.x[kPositions + j]);
        }
        double from_impulse = 0.0;
        for (int r = 0; r < 2 * kFeet; ++r)
          from_impulse += kinematics.foot_jacobian[r][i] * impact.impulse[r];
        ASSERT_NEAR(change, from_impulse, 1e-9) << "sample " << n << " coordinate " << i;
      }
    }
  }
}

TYPED_TEST(PhysicsTest, StandingStillOnStraightLegsNeedsNoTorqueAndHalfTheWeightOnEachFoot) {
  double x[kStates] = {};
  double u[model::kInputs] = {};
  double mass = TypeParam::mass_matrix(x, TypeParam::joint_parameters()).mass_matrix[0][0];
  u[5] = u[7] = 0.5 * mass * 9.81;
  const model::NodeTerms<double> node = TypeParam::node(x, u, TypeParam::joint_parameters());
  for (const double acceleration : node.base_acceleration) EXPECT_NEAR(acceleration, 0.0, 1e-12);
  for (const double torque : node.joint_torque) EXPECT_NEAR(torque, 0.0, 1e-12);
}

}  // namespace
}  // namespace stilt::testing_support
