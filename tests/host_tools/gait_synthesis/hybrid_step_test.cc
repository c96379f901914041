#include "host_tools/gait_synthesis/hybrid_step.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <utility>

#include "host_tools/gait_synthesis/return_map.h"
#include "tests/host_tools/gait_synthesis/sample_gaits.h"
#include "tests/robots.h"

namespace stilt::gait_synthesis {
namespace {

using model::kFirstJoint;
using model::kJoints;
using model::kPositions;
using model::StateVector;

/// Disturbed, but not so much that the phase would be held at its bound of -0.1.
StateVector disturbed_start(const gait::HzdGait& gait) {
  ReducedState r = reduce(start_of_motion(gait));
  r[1] += 0.01;
  r[3] -= 0.02;
  r[5] += 0.1;
  return expand(testing_support::amber3m(), r);
}

double kinetic_energy_J(const StateVector& x) {
  model::MassMatrixTerms<double> mass;
  testing_support::amber3m().mass_matrix(x.data(), testing_support::amber3m().constants.joint_parameters,
                                         mass);
  double energy = 0.0;
  for (int r = 0; r < kPositions; ++r) {
    for (int c = 0; c < kPositions; ++c)
      energy += 0.5 * x[kPositions + r] * mass.mass_matrix[r][c] * x[kPositions + c];
  }
  return energy;
}

/// Power of the joint torques less that against gravity (the bias at rest), W.
double power_W(const StateVector& x, const model::JointVector& torque_Nm) {
  StateVector still = x;
  still.tail<kPositions>().setZero();
  model::BiasTerms<double> gravity;
  testing_support::amber3m().bias(still.data(), gravity);
  double power = torque_Nm.dot(x.tail<kJoints>());
  for (int i = 0; i < kPositions; ++i) power -= gravity.bias[i] * x[kPositions + i];
  return power;
}

TEST(HybridStep, KeepsTheStanceFootAtTheOriginUnderAnyDisturbance) {
  const gait::HzdGait& gait = walking_gait();
  StepOptions options;
  options.keep_samples = true;
  const auto step = integrate_step(testing_support::amber3m(), gait, disturbed_start(gait), options);
  ASSERT_TRUE(step);
  for (const StepSample& sample : step->samples) {
    model::KinematicsTerms<double> feet;
    testing_support::amber3m().kinematics(sample.x.data(), feet);
    EXPECT_NEAR(feet.foot_position[0], 0.0, 1e-9);
    EXPECT_NEAR(feet.foot_position[1], 0.0, 1e-9);
  }
}

TEST(HybridStep, ChangesEnergyByTheWorkOfJointsAndGravity) {
  const gait::HzdGait& gait = walking_gait();
  const StateVector start = disturbed_start(gait);
  constexpr int kSamples = 2000;
  const double end_s = 0.8 * gait.step_time_s;
  const auto states = states_at(testing_support::amber3m(), gait, start,
                                Eigen::VectorXd::LinSpaced(kSamples + 1, 0.0, end_s));
  double work_J = 0.0;  // Simpson's rule
  for (int i = 0; i <= kSamples; ++i) {
    const StateVector& x = states[static_cast<std::size_t>(i)];
    const double time_s = end_s * i / kSamples;
    const auto acceleration = output_feedback(testing_support::amber3m(), gait, x, time_s, 0.0);
    const double power = power_W(x, stance_motion(testing_support::amber3m(), x, acceleration).torque_Nm);
    work_J += power * (i == 0 || i == kSamples ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) * end_s / kSamples / 3.0;
  }
  EXPECT_NEAR(kinetic_energy_J(states.back()) - kinetic_energy_J(states.front()), work_J, 1e-6);
}

TEST(OutputFeedback, MakesTheOutputErrorDecayAsItsEquationSays) {
  for (const gait::HzdGait* gait : {&walking_gait(), &stepping_gait()}) {
    const double kp = gait->feedback.kp_1_s2;
    ASSERT_DOUBLE_EQ(gait->feedback.kd_1_s, 2.0 * std::sqrt(kp)) << "critically damped";
    const double pole = std::sqrt(kp);
    const StateVector start = disturbed_start(*gait);
    const Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(9, 0.0, 0.2);
    const auto states = states_at(testing_support::amber3m(), *gait, start, times);
    const auto error_of = [&](const StateVector& x, double time_s) -> model::JointVector {
      return x.segment<kJoints>(kFirstJoint) -
             gait::outputs_at(gait->outputs, phase_of(gait->outputs, x, time_s)).angle_rad;
    };
    constexpr double kMove_s = 1e-5;
    const auto soon =
        states_at(testing_support::amber3m(), *gait, start, Eigen::VectorXd::Constant(1, kMove_s));
    const model::JointVector e0 = error_of(start, 0.0);
    // The rate of the error at the start, from e(h) = e0 + h r0 - h^2 (kd r0 + kp e0) / 2.
    const model::JointVector r0 = (error_of(soon[0], kMove_s) - e0 * (1.0 - 0.5 * kp * kMove_s * kMove_s)) /
                                  (kMove_s * (1.0 - pole * kMove_s));
    for (Eigen::Index i = 0; i < times.size(); ++i) {
      const double t = times[i];
      const model::JointVector wanted = (e0 + (r0 + pole * e0) * t) * std::exp(-pole * t);
      const model::JointVector got = error_of(states[static_cast<std::size_t>(i)], t);
      EXPECT_LT((got - wanted).cwiseAbs().maxCoeff(), 1e-6) << "after " << t << " s";
    }
  }
}

TEST(TouchDown, PutsTheNewStanceFootToRestAtTheOrigin) {
  const gait::HzdGait& gait = walking_gait();
  const auto step = integrate_step(testing_support::amber3m(), gait, disturbed_start(gait));
  ASSERT_TRUE(step);
  model::KinematicsTerms<double> feet;
  testing_support::amber3m().kinematics(step->after.data(), feet);
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(feet.foot_position[i], 0.0, 1e-12);
    EXPECT_NEAR(feet.foot_velocity[i], 0.0, 1e-12);
  }
  EXPECT_EQ(step->after[kFirstJoint], step->before[kFirstJoint + 2]);
  EXPECT_EQ(step->after[kFirstJoint + 3], step->before[kFirstJoint + 1]);
  EXPECT_GT(step->impulse_Ns[1], 0.0);
}

TEST(Phase, GoesFromZeroToOneOverTheStepAndIsHeldATenthBeyond) {
  for (const gait::HzdGait* gait : {&walking_gait(), &stepping_gait()}) {
    const gait::GaitOutputs& outputs = gait->outputs;
    const double span = outputs.phase_end - outputs.phase_start;
    for (const auto& [share, phase] :
         {std::pair{0.0, 0.0}, {0.25, 0.25}, {1.0, 1.0}, {-0.05, -0.05}, {-0.2, -0.1}, {1.3, 1.1}}) {
      StateVector x = StateVector::Zero();
      x[0] = outputs.phase_start + share * span;
      EXPECT_NEAR(phase_of(outputs, x, x[0]), phase, 1e-12) << share;
    }
  }
}

/// A swing foot that comes down just after it has left the ground stumbles, and does not end the step.
TEST(IntegrateStep, OnlyTheSecondHalfOfTheStepEndsWithTouchDown) {
  ReducedState r = reduce(start_of_motion(walking_gait()));
  r[4] += 0.01;
  r[9] -= 9.0;
  StepOptions options;
  options.keep_samples = true;
  const auto step = integrate_step(testing_support::amber3m(), walking_gait(),
                                   expand(testing_support::amber3m(), r), options);
  ASSERT_TRUE(step);
  const auto height_m = [](const StepSample& sample) {
    model::KinematicsTerms<double> feet;
    testing_support::amber3m().kinematics(sample.x.data(), feet);
    return feet.foot_position[3];
  };
  int early_contacts = 0;
  for (std::size_t i = 1; i < step->samples.size() && step->samples[i].time_s < 0.4 * step->duration_s; ++i) {
    if (height_m(step->samples[i - 1]) > 0.0 && height_m(step->samples[i]) <= 0.0) ++early_contacts;
  }
  EXPECT_EQ(early_contacts, 1);
  EXPECT_GT(step->duration_s, 0.6 * walking_gait().step_time_s);
}

TEST(IntegrateStep, ReportsWhenTheRobotFalls) {
  ReducedState r = reduce(start_of_motion(walking_gait()));
  r[kReducedStates / 2] = -8.0;
  EXPECT_FALSE(
      integrate_step(testing_support::amber3m(), walking_gait(), expand(testing_support::amber3m(), r)));
}

/// AMBER-3M of `scale` times its size, of the same density.
model::RobotModel scaled(double scale) {
  model::RobotConstants robot = testing_support::amber3m().constants;
  const double mass = std::pow(scale, 3);
  const double inertia = std::pow(scale, 5);
  const double factors[] = {mass, scale, inertia,         // torso: mass, centre of mass, inertia
                            mass, scale, inertia, scale,  // thigh: length, too
                            mass, scale, inertia, scale};
  static_assert(std::size(factors) == model::kNumbers);
  for (int i = 0; i < model::kNumbers; ++i) robot.numbers[i] *= factors[i];
  for (int j = 0; j < kJoints; ++j) robot.joint_parameters[j] *= inertia;
  return model::make_robot(robot);
}

/// Robots of one shape walk alike: lengths grow with the scale, and times with its root.
TEST(IntegrateStep, ASmallRobotStepsAsALargeOneDoes) {
  const ReducedState nominal = reduce(start_of_motion(walking_gait()));
  const auto large =
      integrate_step(testing_support::amber3m(), walking_gait(), expand(testing_support::amber3m(), nominal));
  ASSERT_TRUE(large);
  for (const double scale : {0.3, 2.0}) {
    const double time = std::sqrt(scale);
    gait::HzdGait gait = walking_gait();
    gait.outputs.phase_start *= scale;
    gait.outputs.phase_end *= scale;
    gait.step_time_s *= time;
    gait.feedback.kp_1_s2 /= scale;
    gait.feedback.kd_1_s /= time;
    const model::RobotModel robot = scaled(scale);
    ReducedState start = nominal;
    start.tail<model::kAngles>() /= time;
    const auto step = integrate_step(robot, gait, expand(robot, start));
    ASSERT_TRUE(step) << "scale " << scale;
    EXPECT_NEAR(step->duration_s, time * large->duration_s, 1e-9) << "scale " << scale;
    EXPECT_NEAR(step->after[1], scale * large->after[1], 1e-9) << "scale " << scale;
  }
}

TEST(ReturnMap, HasTheEigenvalueThatTheMomentumAboutTheStanceFootGives) {
  // On the zero dynamics half the squared momentum about the stance foot is scaled by (H+ / H-)^2 at
  // touch-down. It gains the same over every step. That ratio is the eigenvalue of the return map
  // (Westervelt, Grizzle, Koditschek 2003). The outputs' own eigenvalues are far smaller.
  const auto momentum = [](const StateVector& x) {  // the left foot at the origin
    model::MassMatrixTerms<double> mass;
    testing_support::amber3m().mass_matrix(x.data(), testing_support::amber3m().constants.joint_parameters,
                                           mass);
    double p[3] = {};
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < kPositions; ++c) p[r] += mass.mass_matrix[r][c] * x[kPositions + c];
    }
    return p[2] + x[1] * p[0] - x[0] * p[1];
  };
  const gait::HzdGait& gait = walking_gait();
  const auto step = integrate_step(testing_support::amber3m(), gait, start_of_motion(gait));
  ASSERT_TRUE(step);
  const double ratio = momentum(step->after) / momentum(step->before);
  const auto map = linearise_return_map(testing_support::amber3m(), gait, reduce(start_of_motion(gait)));
  ASSERT_TRUE(map);
  EXPECT_NEAR(map->spectral_radius(), ratio * ratio, 2e-3);
  EXPECT_LT(map->eigenvalue_magnitudes[1], 0.05);
}

TEST(ReturnMap, AFixedPointReturnsToItself) {
  const model::RobotModel& robot = testing_support::amber3m();
  const gait::HzdGait& gait = walking_gait();
  ReducedState start = reduce(start_of_motion(gait));
  start.array() += 0.01;
  const auto found = find_fixed_point(robot, gait, start);
  ASSERT_TRUE(found);
  const auto step = integrate_step(robot, gait, expand(robot, *found));
  ASSERT_TRUE(step);
  EXPECT_LT((reduce(step->after) - *found).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(ReturnMap, PredictsHowADisturbanceDecays) {
  for (const gait::HzdGait* gait : {&walking_gait(), &stepping_gait()}) {
    const ReducedState nominal = reduce(start_of_motion(*gait));
    const auto map = linearise_return_map(testing_support::amber3m(), *gait, nominal);
    ASSERT_TRUE(map);
    ASSERT_LT(map->spectral_radius(), 1.0);
    ReducedState error = ReducedState::Zero();
    error[0] = 1e-3;
    error[6] = -5e-3;
    ReducedState at = nominal + error;
    for (int step = 0; step < 4; ++step) {
      const auto outcome =
          integrate_step(testing_support::amber3m(), *gait, expand(testing_support::amber3m(), at));
      ASSERT_TRUE(outcome);
      error = map->jacobian * error;
      at = reduce(outcome->after);
      EXPECT_LT((at - nominal - error).cwiseAbs().maxCoeff(), 2e-3);
    }
  }
}

}  // namespace
}  // namespace stilt::gait_synthesis
