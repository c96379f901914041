#include <cmath>
#include <functional>

#include "tests/codegen/generated/robots.h"

namespace stilt::testing_support {
namespace {

using model::kAngles;
using model::kChain;
using model::kChainAngles;
using model::kFeet;
using model::kFirstAngle;
using model::kInputs;
using model::kJoints;
using model::kPositions;
using model::kStates;
using Complex = std::complex<double>;

constexpr unsigned kSeed = 41;
constexpr int kSamples = 200;
constexpr double kStep = 1e-30;
constexpr double kTolerance = 1e-10;  // relative; a complex step is exact to rounding

template <class Robot>
class DerivativesTest : public testing::Test {};
TYPED_TEST_SUITE(DerivativesTest, Robots);

/// A sample whose x[state] or u[input] has an imaginary step.
struct Stepped {
  Complex x[kStates];
  Complex u[kInputs];
  Complex p[2 * kJoints];

  explicit Stepped(const Sample& s, int state, int input) {
    for (int i = 0; i < kStates; ++i) x[i] = {s.x[i], i == state ? kStep : 0.0};
    for (int i = 0; i < kInputs; ++i) u[i] = {s.u[i], i == input ? kStep : 0.0};
    for (int i = 0; i < 2 * kJoints; ++i) p[i] = s.p[i];
  }
};

double derivative(const Complex& value) { return value.imag() / kStep; }

/// Compares one column of a matrix of derivatives with the stepped values.
template <int kRows, int kColumns>
void expect_column(const double (&matrix)[kRows][kColumns], int column, const Complex (&stepped)[kRows],
                   const char* name) {
  double scale = 1.0;
  for (const Complex& value : stepped) scale = std::max(scale, std::abs(derivative(value)));
  for (int r = 0; r < kRows; ++r) {
    ASSERT_NEAR(matrix[r][column], derivative(stepped[r]), kTolerance * scale)
        << name << " row " << r << " column " << column;
  }
}

template <class Robot>
void expect_node_columns(const Sample& s) {
  const model::NodeDerivatives<double> d = Robot::node_derivatives(s.x.data(), s.u.data(), s.p.data());
  for (int c = 0; c < kAngles; ++c) {
    const Stepped by_angle(s, kFirstAngle + c, -1);
    const Stepped by_rate(s, kPositions + kFirstAngle + c, -1);
    const model::NodeTerms<Complex> theta = Robot::node(by_angle.x, by_angle.u, by_angle.p);
    const model::NodeTerms<Complex> omega = Robot::node(by_rate.x, by_rate.u, by_rate.p);
    expect_column(d.base_acceleration_dtheta, c, theta.base_acceleration, "base_acceleration_dtheta");
    expect_column(d.base_acceleration_domega, c, omega.base_acceleration, "base_acceleration_domega");
    expect_column(d.foot_acceleration_dtheta, c, theta.foot_acceleration, "foot_acceleration_dtheta");
    expect_column(d.foot_acceleration_domega, c, omega.foot_acceleration, "foot_acceleration_domega");
    expect_column(d.joint_torque_dtheta, c, theta.joint_torque, "joint_torque_dtheta");
    expect_column(d.joint_torque_domega, c, omega.joint_torque, "joint_torque_domega");
    double position[2 * kFeet][kAngles] = {};
    double velocity[2 * kFeet][kAngles] = {};
    for (int r = 0; r < 2 * kFeet; ++r) {
      for (int i = 0; i < kChain; ++i) {
        position[r][kChainAngles[r / 2][i]] = d.foot_position_dchain[r][i];
        velocity[r][kChainAngles[r / 2][i]] = d.foot_velocity_dchain[r][i];
      }
    }
    expect_column(position, c, theta.foot_position, "foot_position_dchain");
    expect_column(velocity, c, theta.foot_velocity, "foot_velocity_dchain");
    expect_column(position, c, omega.foot_velocity, "foot_position_dchain as rate");
  }
  for (int c = 0; c < kInputs; ++c) {
    const Stepped by_input(s, -1, c);
    const model::NodeTerms<Complex> input = Robot::node(by_input.x, by_input.u, by_input.p);
    expect_column(d.base_acceleration_du, c, input.base_acceleration, "base_acceleration_du");
    expect_column(d.foot_acceleration_du, c, input.foot_acceleration, "foot_acceleration_du");
    expect_column(d.joint_torque_du, c, input.joint_torque, "joint_torque_du");
  }
}

TYPED_TEST(DerivativesTest, NodeDerivativesAreThoseOfTheNode) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937_64 random(kSeed);
  for (int n = 0; n < kSamples && !this->HasFatalFailure(); ++n)
    expect_node_columns<TypeParam>(Sample(random));
}

TYPED_TEST(DerivativesTest, NothingDependsOnWhereTheBaseStandsOrHowFastItMoves) {
  std::mt19937_64 random(kSeed);
  const Sample s(random);
  for (const int state : {0, 1, kPositions, kPositions + 1}) {
    const Stepped stepped(s, state, -1);
    const model::NodeTerms<Complex> node = TypeParam::node(stepped.x, stepped.u, stepped.p);
    for (const Complex& value : node.base_acceleration) EXPECT_EQ(derivative(value), 0.0);
    for (const Complex& value : node.foot_acceleration) EXPECT_EQ(derivative(value), 0.0);
    for (const Complex& value : node.joint_torque) EXPECT_EQ(derivative(value), 0.0);
  }
}

TYPED_TEST(DerivativesTest, TheSmallerFunctionsAgreeWithTheFusedOne) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937_64 random(kSeed);
  for (int n = 0; n < kSamples; ++n) {
    const Sample s(random);
    const auto d = TypeParam::node_derivatives(s.x.data(), s.u.data(), s.p.data());
    const auto flow = TypeParam::flow(s.x.data(), s.u.data());
    const auto flow_d = TypeParam::flow_derivatives(s.x.data(), s.u.data());
    const auto node = TypeParam::node(s.x.data(), s.u.data(), s.p.data());
    const auto close = [](double a, double b) { return std::abs(a - b) <= 1e-11 * (1.0 + std::abs(b)); };
    for (int r = 0; r < 3; ++r) {
      EXPECT_PRED2(close, flow.base_acceleration[r], d.base_acceleration[r]);
      EXPECT_PRED2(close, flow_d.base_acceleration[r], d.base_acceleration[r]);
      EXPECT_PRED2(close, node.base_acceleration[r], d.base_acceleration[r]);
      for (int c = 0; c < kAngles; ++c) {
        EXPECT_PRED2(close, flow_d.base_acceleration_dtheta[r][c], d.base_acceleration_dtheta[r][c]);
        EXPECT_PRED2(close, flow_d.base_acceleration_domega[r][c], d.base_acceleration_domega[r][c]);
      }
      for (int c = 0; c < kInputs; ++c) {
        EXPECT_PRED2(close, flow_d.base_acceleration_du[r][c], d.base_acceleration_du[r][c]);
      }
    }
    for (int r = 0; r < 4; ++r) {
      EXPECT_PRED2(close, node.foot_position[r], d.foot_position[r]);
      EXPECT_PRED2(close, node.foot_velocity[r], d.foot_velocity[r]);
      EXPECT_PRED2(close, node.foot_acceleration[r], d.foot_acceleration[r]);
      EXPECT_PRED2(close, node.joint_torque[r], d.joint_torque[r]);
    }
  }
}

TYPED_TEST(DerivativesTest, ImpactDerivativesAreThoseOfTheImpact) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937_64 random(kSeed);
  for (int n = 0; n < kSamples && !this->HasFatalFailure(); ++n) {
    const Sample s(random);
    for (const model::ContactMode contact : kLandings) {
      const model::ImpactDerivatives<double> d =
          TypeParam::impact_derivatives(contact, s.x.data(), s.p.data());
      for (int c = 0; c < kAngles; ++c) {
        const Stepped by_angle(s, kFirstAngle + c, -1);
        const model::ImpactTerms<Complex> theta = TypeParam::impact(contact, by_angle.x, by_angle.p);
        expect_column(d.velocity_after_dtheta, c, theta.velocity_after, "velocity_after_dtheta");
        expect_column(d.impulse_dtheta, c, theta.impulse, "impulse_dtheta");
      }
      for (int c = 0; c < kPositions; ++c) {
        const Stepped by_velocity(s, kPositions + c, -1);
        const model::ImpactTerms<Complex> dv = TypeParam::impact(contact, by_velocity.x, by_velocity.p);
        expect_column(d.velocity_after_dv, c, dv.velocity_after, "velocity_after_dv");
        expect_column(d.impulse_dv, c, dv.impulse, "impulse_dv");
      }
    }
  }
}

}  // namespace
}  // namespace stilt::testing_support
