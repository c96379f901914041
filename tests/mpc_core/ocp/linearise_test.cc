#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "mpc_core/lq/riccati.h"
#include "tests/mpc_core/lq/dense_stage.h"
#include "tests/mpc_core/ocp/planning_scene.h"
#include "tests/mpc_core/ocp/scalar_ocp.h"
#include "tests/mpc_core/ocp/zero_padding.h"
#include "tests/robots.h"

namespace stilt::ocp {
namespace {

using lq::kRows;
using model::kInputs;
using model::kStates;
using testing_support::kStageVariables;
using testing_support::Linearisation;
using testing_support::LqStage;
using testing_support::ScalarOcp;
using testing_support::Scene;
using testing_support::StageVector;

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using Padded = Eigen::Map<const Eigen::Matrix<double, kRows, Eigen::Dynamic>>;

/// One stage of the linearisation as plain matrices. The map from (dx, w) to the step of z = [x; u] is
/// dz = offset + basis [dx; w].
struct DenseStage {
  Matrix dynamics;  ///< [A B]
  Vector defect;
  Matrix hessian;  ///< [Q S'; S R]
  Vector gradient;
  Matrix basis;
  StageVector<double> offset;

  DenseStage(const LqStage& lq_stage, const InputProjection& p) {
    const int free = lq_stage.free_inputs;
    const int n = kStates + free;
    dynamics.resize(kStates, n);
    dynamics << lq::testing::dense_dynamics(lq_stage),
        Padded(&lq_stage.B[0][0], kRows, free).topRows(kStates);
    defect = Eigen::Map<const Vector>(lq_stage.b, kStates);
    hessian.resize(n, n);
    hessian.topLeftCorner(kStates, kStates) = lq::testing::dense_hessian(lq_stage);
    hessian.topRightCorner(kStates, free) = Padded(&lq_stage.S[0][0], kRows, free).topRows(kStates);
    hessian.bottomLeftCorner(free, kStates) = hessian.topRightCorner(kStates, free).transpose();
    gradient.resize(n);
    gradient.head(kStates) = Eigen::Map<const Vector>(lq_stage.q, kStates);
    for (int i = 0; i < free; ++i) {
      gradient[kStates + i] = lq_stage.r[i];
      for (int j = i; j < free; ++j) {
        hessian(kStates + i, kStates + j) = hessian(kStates + j, kStates + i) = lq_stage.R[i][j];
      }
    }
    basis = Matrix::Zero(kStageVariables, n);
    basis.topLeftCorner(kStates, kStates).setIdentity();
    basis.bottomLeftCorner(kInputs, kStates) = testing_support::inputs_by_state(lq_stage, p);
    basis.bottomRightCorner(kInputs, free) = testing_support::inputs_by_free(lq_stage, p);
    offset << model::StateVector::Zero(), Eigen::Map<const model::InputVector>(p.u0);
  }
};

/// Gradient and Gauss-Newton Hessian of a stage's cost in z, from derivatives of every single term.
struct GaussNewton {
  Vector gradient = Vector::Zero(kStageVariables);
  Matrix hessian = Matrix::Zero(kStageVariables, kStageVariables);

  GaussNewton(const Scene& scene, int k) {
    const ScalarOcp scalar(scene.data);
    const Stage& stage = scene.problem.horizon.stage[static_cast<std::size_t>(k)];
    const gait::ReferencePoint& point = scene.points[static_cast<std::size_t>(k)];
    const StageVector<double> z = testing_support::stage_variables(scene.guess, k);
    const auto arguments = [&](const StageVector<testing_support::Complex>& at) {
      std::vector<testing_support::Complex> values;
      for (const auto& term : scalar.cost_terms(stage.mode, point, at)) values.push_back(term.y);
      return values;
    };
    const Matrix rows = testing_support::jacobian(arguments, z);
    const auto terms = scalar.cost_terms(stage.mode, point, z);
    for (std::size_t t = 0; t < terms.size(); ++t) {
      const Vector row = rows.row(static_cast<Eigen::Index>(t)).transpose();
      gradient += stage.duration_s * terms[t].first() * row;
      hessian += stage.duration_s * terms[t].second() * row * row.transpose();
    }
  }
};

/// One group of batches that are linearised together, and a stage of the next.
constexpr int kStages = kBatchesPerGroup * kLanes + 1;

template <class Check>
void for_random_stages(const Check& check) {
  for (const model::RobotModel* robot : {&testing_support::amber3m(), &testing_support::rabbit()}) {
    for (const model::ContactMode mode : testing_support::kAllModes) {
      for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        SCOPED_TRACE(testing::Message()
                     << robot->constants.name << " L" << mode.left << " R" << mode.right << " seed " << seed);
        const auto scene = testing_support::random_scene(*robot, mode, kStages, seed);
        scene->data.discretisation.integrator = seed % 2 == 0 ? Integrator::rk2 : Integrator::rk4;
        const Linearisation model(scene->data, scene->problem, scene->guess);
        for (int k = 0; k < scene->problem.horizon.stages; ++k) {
          const auto index = static_cast<std::size_t>(k);
          check(*scene, k, DenseStage(model.stages[index], model.projections[index]));
        }
      }
    }
  }
}

double relative(const Matrix& a, const Matrix& b) { return (a - b).norm() / (1e-12 + b.norm()); }

TEST(Linearise, DynamicsAreTheDerivativesOfTheIntegratedStep) {
  for_random_stages([](const Scene& scene, int k, const DenseStage& stage) {
    const double duration_s = scene.problem.horizon.stage[static_cast<std::size_t>(k)].duration_s;
    const ScalarOcp scalar(scene.data);
    const auto step = [&](const auto& z) { return scalar.step(z, duration_s); };
    const StageVector<double> z = testing_support::stage_variables(scene.guess, k);
    const Matrix by_z = testing_support::jacobian(step, z);
    const Vector reached = step(z) - Eigen::Map<const model::StateVector>(scene.guess.x[k + 1]);
    EXPECT_LT(relative(stage.dynamics, by_z * stage.basis), 1e-11);
    EXPECT_LT(relative(stage.defect, reached + by_z * stage.offset), 1e-11);
  });
}

TEST(Linearise, CostIsTheGaussNewtonModelOfEveryTermInTheFreeDirections) {
  for_random_stages([](const Scene& scene, int k, const DenseStage& stage) {
    const GaussNewton plain(scene, k);
    const Matrix hessian = stage.basis.transpose() * plain.hessian * stage.basis;
    const Vector gradient = stage.basis.transpose() * (plain.gradient + plain.hessian * stage.offset);
    EXPECT_LT(relative(stage.hessian, hessian), 1e-10);
    EXPECT_LT(relative(stage.gradient, gradient), 1e-10);
  });
}

TEST(Linearise, SlopeAlongTheStepOntoTheConstraintsIsTheGradientsShare) {
  for (const model::ContactMode mode : testing_support::kAllModes) {
    const auto scene = testing_support::random_scene(testing_support::amber3m(), mode, kLanes + 1, 8);
    const Linearisation model(scene->data, scene->problem, scene->guess);
    for (int k = 0; k < scene->problem.horizon.stages; ++k) {
      const InputProjection& p = model.projections[static_cast<std::size_t>(k)];
      const double expected =
          GaussNewton(*scene, k).gradient.tail<kInputs>().dot(Eigen::Map<const model::InputVector>(p.u0));
      EXPECT_NEAR(p.u0_slope, expected, 1e-10 * (1.0 + std::abs(expected)));
    }
  }
}

TEST(Linearise, HessianIsPositiveSemidefinite) {
  for_random_stages([](const Scene&, int, const DenseStage& stage) {
    const Vector eigenvalues = Eigen::SelfAdjointEigenSolver<Matrix>(stage.hessian).eigenvalues();
    EXPECT_GT(eigenvalues.minCoeff(), -1e-13 * eigenvalues.maxCoeff());
  });
}

TEST(Linearise, WritesZeroToThePadding) {
  for (const model::ContactMode mode : testing_support::kAllModes) {
    const auto scene = testing_support::random_scene(testing_support::amber3m(), mode, 3, 9);
    testing_support::expect_zero_padding({scene->data, scene->problem, scene->guess});
  }
}

/// Moves the inputs onto the equality constraints, which are affine in them.
void fulfil_equalities(Scene& scene) {
  const Linearisation model(scene.data, scene.problem, scene.guess);
  for (int k = 0; k < scene.problem.horizon.stages; ++k) {
    for (int i = 0; i < kInputs; ++i)
      scene.guess.u[k][i] += model.projections[static_cast<std::size_t>(k)].u0[i];
  }
}

TEST(Linearise, SlopeAlongFreeDirectionsIsTheDifferenceOfTheEvaluatedCost) {
  for (const double time_s : {0.1, 0.4, 0.65}) {
    for (const double double_support_s : {0.0, 0.06}) {
      SCOPED_TRACE(testing::Message() << "at " << time_s << " double support " << double_support_s);
      testing_support::SceneOptions options;
      options.time_s = time_s;
      options.gait.double_support_s = double_support_s;
      const auto scene = testing_support::walking_scene(options);
      const int stages = scene->problem.horizon.stages;
      for (int i = 0; i < kStates; ++i) scene->data.terminal_weight[i][i] = 50.0 + i;
      testing_support::disturb(scene->guess, stages, 0.05, 71);
      fulfil_equalities(*scene);
      const Linearisation model(scene->data, scene->problem, scene->guess);

      for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        std::mt19937_64 random(seed);
        std::normal_distribution<double> normal;
        std::vector<lq::LqStep> steps(static_cast<std::size_t>(stages) + 1);
        Trajectory forward = scene->guess;
        Trajectory backward = scene->guess;
        constexpr double kStep = 1e-5;
        for (int k = 0; k <= stages; ++k) {
          lq::LqStep& step = steps[static_cast<std::size_t>(k)];
          step = {};
          for (int i = 0; i < kStates; ++i) {
            step.x[i] = normal(random);
            forward.x[k][i] += kStep * step.x[i];
            backward.x[k][i] -= kStep * step.x[i];
          }
          if (k == stages) break;
          const LqStage& lq_stage = model.stages[static_cast<std::size_t>(k)];
          const InputProjection& p = model.projections[static_cast<std::size_t>(k)];
          for (int c = 0; c < lq_stage.free_inputs; ++c) step.w[c] = normal(random);
          const model::InputVector du =
              testing_support::inputs_by_state(lq_stage, p) * Eigen::Map<const model::StateVector>(step.x) +
              testing_support::inputs_by_free(lq_stage, p) *
                  Eigen::Map<const Vector>(step.w, lq_stage.free_inputs);
          for (int i = 0; i < kInputs; ++i) {
            forward.u[k][i] += kStep * du[i];
            backward.u[k][i] -= kStep * du[i];
          }
        }
        const auto dot = [](const double* a, const double* b, int count) {
          return Eigen::Map<const Vector>(a, count).dot(Eigen::Map<const Vector>(b, count));
        };
        double slope = dot(model.terminal.q, steps[static_cast<std::size_t>(stages)].x, kStates);
        for (int k = 0; k < stages; ++k) {
          const LqStage& stage = model.stages[static_cast<std::size_t>(k)];
          const lq::LqStep& step = steps[static_cast<std::size_t>(k)];
          slope += dot(stage.q, step.x, kStates) + dot(stage.r, step.w, stage.free_inputs);
        }
        const double difference = (evaluate(scene->data, scene->problem, forward).cost -
                                   evaluate(scene->data, scene->problem, backward).cost) /
                                  (2.0 * kStep);
        // The difference's own error: rounding of a cost near 10 over the step, and third derivatives.
        EXPECT_NEAR(slope, difference, 1e-6 * (100.0 + std::abs(slope))) << "seed " << seed;
      }
    }
  }
}

}  // namespace
}  // namespace stilt::ocp
