#include "mpc_core/ocp/integrator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/mpc_core/ocp/planning_scene.h"
#include "tests/mpc_core/ocp/scalar_ocp.h"
#include "tests/robots.h"

namespace stilt::ocp {
namespace {

using model::kInputs;
using model::kJoints;
using model::kLanes;
using model::kPositions;
using model::kStates;
using testing_support::ScalarOcp;
using testing_support::StageVector;
using testing_support::StateOf;

constexpr Integrator kIntegrators[] = {Integrator::rk2, Integrator::rk4};
constexpr std::uint64_t kSeed = 21;

StageVector<double> random_variables(std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  StageVector<double> z;
  for (int i = 0; i < kStates; ++i) z[i] = (i < kPositions ? 1.0 : 6.0) * uniform(random);
  for (int i = 0; i < kInputs; ++i) z[kStates + i] = (i < kJoints ? 40.0 : 200.0) * uniform(random);
  return z;
}

/// kLanes different steps at once by the code under test.
class BatchedStep {
 public:
  BatchedStep(const ProblemData& data, const StageVector<double> (&z)[kLanes],
              const double (&duration_s)[kLanes])
      : h_([&](auto lane) { return duration_s[lane]; }) {
    for (int i = 0; i < kStates; ++i) x_[i] = Batch([&](auto lane) { return z[lane][i]; });
    for (int i = 0; i < kInputs; ++i) u_[i] = Batch([&](auto lane) { return z[lane][kStates + i]; });
    Batch p[2 * kJoints];
    for (int i = 0; i < 2 * kJoints; ++i) p[i] = Batch(data.joint_parameters[i]);
    data.robot->node_derivatives(x_, u_, p, node_);
    integrate_base(*data.robot, data.discretisation.integrator, x_, u_, h_, node_.base_acceleration, plain_);
    integrate_base_derivatives(*data.robot, data.discretisation.integrator, x_, u_, h_, node_, step_, work_);
    next_state(x_, u_, h_, plain_, reached_);
  }

  [[nodiscard]] StateOf<double> reached(int lane) const {
    StateOf<double> state;
    for (int i = 0; i < kStates; ++i) state[i] = reached_[i][lane];
    return state;
  }
  [[nodiscard]] const BaseMotion& plain() const { return plain_; }
  [[nodiscard]] const BaseStep& with_derivatives() const { return step_; }

 private:
  Batch x_[kStates];
  Batch u_[kInputs];
  Batch h_;
  model::NodeDerivatives<Batch> node_;
  BaseMotion plain_;
  BaseStep step_;
  IntegratorWorkspace work_;
  Batch reached_[kStates];
};

TEST(Integrator, StepsLikeTheTextbookMethodOnAllFourteenStates) {
  std::mt19937_64 random(kSeed);
  for (const model::RobotModel* robot : {&testing_support::amber3m(), &testing_support::rabbit()}) {
    ProblemData data = testing_support::default_data(*robot);
    for (const Integrator integrator : kIntegrators) {
      data.discretisation.integrator = integrator;
      for (int sample = 0; sample < 50; ++sample) {
        StageVector<double> z[kLanes];
        double duration_s[kLanes];
        for (int lane = 0; lane < kLanes; ++lane) {
          z[lane] = random_variables(random);
          duration_s[lane] = 0.002 + 0.006 * lane;
        }
        const BatchedStep batched(data, z, duration_s);
        for (int lane = 0; lane < kLanes; ++lane) {
          const StateOf<double> expected = ScalarOcp(data).step(z[lane], duration_s[lane]);
          const StateOf<double> error = batched.reached(lane) - expected;
          ASSERT_LT(error.lpNorm<Eigen::Infinity>(), 1e-12 * (1.0 + expected.lpNorm<Eigen::Infinity>()))
              << robot->constants.name << " seed " << kSeed << " sample " << sample << " lane " << lane;
        }
      }
    }
  }
}

TEST(Integrator, WithDerivativesTakesTheSameStep) {
  std::mt19937_64 random(kSeed);
  ProblemData data = testing_support::default_data(testing_support::amber3m());
  for (const Integrator integrator : kIntegrators) {
    data.discretisation.integrator = integrator;
    StageVector<double> z[kLanes];
    double duration_s[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) {
      z[lane] = random_variables(random);
      duration_s[lane] = 0.015;
    }
    const BatchedStep batched(data, z, duration_s);
    for (int r = 0; r < 3; ++r) {
      for (int lane = 0; lane < kLanes; ++lane) {
        const double position = batched.plain().for_position[r][lane];
        const double velocity = batched.plain().for_velocity[r][lane];
        EXPECT_NEAR(batched.with_derivatives().for_position[r][lane], position,
                    1e-12 * (1.0 + std::abs(position)));
        EXPECT_NEAR(batched.with_derivatives().for_velocity[r][lane], velocity,
                    1e-12 * (1.0 + std::abs(velocity)));
      }
    }
  }
}

/// Distance of one long motion with constant inputs, cut into `steps`, from its limit (many RK4 steps).
double global_error(Integrator integrator, int steps) {
  constexpr double kDuration_s = 0.2;
  ProblemData data = testing_support::default_data(testing_support::amber3m());
  StageVector<double> start;
  start << 0.0, 0.8, 0.1, -0.5, 0.9, -0.2, 0.8, 0.4, 0.1, 0.5, -1.0, 2.0, 1.0, -1.5, 8.0, -12.0, 10.0, 5.0,
      15.0, 120.0, -10.0, 90.0;
  const auto motion = [&](Integrator method, int count) {
    data.discretisation.integrator = method;
    StageVector<double> z[kLanes];
    double duration_s[kLanes];
    std::fill(duration_s, duration_s + kLanes, kDuration_s / count);
    std::fill(z, z + kLanes, start);
    for (int k = 0; k < count; ++k) {
      const StateOf<double> next = BatchedStep(data, z, duration_s).reached(0);
      for (StageVector<double>& lane : z) lane.head<kStates>() = next;
    }
    return StateOf<double>(z[0].head<kStates>());
  };
  static const StateOf<double> limit = motion(Integrator::rk4, 2000);
  return (motion(integrator, steps) - limit).norm();
}

TEST(Integrator, Rk2ConvergesWithOrderTwo) {
  EXPECT_NEAR(std::log2(global_error(Integrator::rk2, 20) / global_error(Integrator::rk2, 40)), 2.0, 0.2);
  EXPECT_NEAR(std::log2(global_error(Integrator::rk2, 40) / global_error(Integrator::rk2, 80)), 2.0, 0.1);
}

TEST(Integrator, Rk4ConvergesWithOrderFour) {
  EXPECT_NEAR(std::log2(global_error(Integrator::rk4, 10) / global_error(Integrator::rk4, 20)), 4.0, 0.4);
  EXPECT_NEAR(std::log2(global_error(Integrator::rk4, 20) / global_error(Integrator::rk4, 40)), 4.0, 0.2);
}

}  // namespace
}  // namespace stilt::ocp
