#include "mpc_core/ocp/projection.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>
#include <random>

#include "tests/mpc_core/ocp/planning_scene.h"
#include "tests/mpc_core/ocp/scalar_ocp.h"
#include "tests/robots.h"

namespace stilt::ocp {
namespace {

using model::kInputs;
using model::kJoints;
using model::kPositions;
using model::kStates;
using testing_support::Linearisation;
using testing_support::LqStage;
using testing_support::ScalarOcp;
using testing_support::Scene;
using testing_support::StageVector;

const Stage& stage_of(const Scene& scene, int k) {
  return scene.problem.horizon.stage[static_cast<std::size_t>(k)];
}

/// Residual of the linearised equalities for a step (dx, du) of stage k.
Eigen::VectorXd linearised_equalities(const Scene& scene, int k, const StageVector<double>& step) {
  const ScalarOcp scalar(scene.data);
  const auto rows = [&](const auto& z) {
    return scalar.equalities(stage_of(scene, k).mode, scene.points[static_cast<std::size_t>(k)], z);
  };
  const StageVector<double> z = testing_support::stage_variables(scene.guess, k);
  const std::vector<double> now = rows(z);
  const Eigen::Map<const Eigen::VectorXd> residual(now.data(), static_cast<Eigen::Index>(now.size()));
  return residual + testing_support::directional(rows, z, step);
}

TEST(Projection, EveryStepItAllowsFulfilsTheLinearisedEqualities) {
  for (const model::RobotModel* robot : {&testing_support::amber3m(), &testing_support::rabbit()}) {
    for (const model::ContactMode mode : testing_support::kAllModes) {
      for (std::uint64_t seed = 1; seed <= 25; ++seed) {
        const auto scene = testing_support::random_scene(*robot, mode, kLanes + 1, seed);
        const Linearisation model(scene->data, scene->problem, scene->guess);
        std::mt19937_64 random(seed);
        std::normal_distribution<double> normal;
        for (int k = 0; k < scene->problem.horizon.stages; ++k) {
          const InputProjection& p = model.projections[static_cast<std::size_t>(k)];
          const LqStage& lq_stage = model.stages[static_cast<std::size_t>(k)];
          const int free = lq_stage.free_inputs;
          const Eigen::VectorXd w = 10.0 * Eigen::VectorXd::NullaryExpr(free, [&] { return normal(random); });
          StageVector<double> step;
          for (int i = 0; i < kStates; ++i) step[i] = normal(random);
          step.tail<kInputs>() = Eigen::Map<const model::InputVector>(p.u0) +
                                 testing_support::inputs_by_state(lq_stage, p) * step.head<kStates>() +
                                 testing_support::inputs_by_free(lq_stage, p) * w;
          // Terms of the sum are of the size of the step times derivatives up to about 100.
          const double scale = 1.0 + step.lpNorm<Eigen::Infinity>();
          ASSERT_LT(linearised_equalities(*scene, k, step).lpNorm<Eigen::Infinity>(), 1e-9 * scale)
              << robot->constants.name << " L" << mode.left << " R" << mode.right << " seed " << seed
              << " stage " << k;
        }
      }
    }
  }
}

TEST(Projection, LeavesThreeDirectionsInSingleSupportFourInDoubleSupportTwoInFlight) {
  for (const model::ContactMode mode : testing_support::kAllModes) {
    const auto scene = testing_support::random_scene(testing_support::amber3m(), mode, kLanes, 5);
    const Linearisation model(scene->data, scene->problem, scene->guess);
    const int expected = 2 + mode.count();
    for (int k = 0; k < kLanes; ++k) {
      const LqStage& lq_stage = model.stages[static_cast<std::size_t>(k)];
      ASSERT_EQ(lq_stage.free_inputs, expected);
      const Eigen::MatrixXd W =
          testing_support::inputs_by_free(lq_stage, model.projections[static_cast<std::size_t>(k)]);
      const Eigen::VectorXd singular = Eigen::JacobiSVD<Eigen::MatrixXd>(W).singularValues();
      EXPECT_GE(singular[expected - 1], 1.0 - 1e-12);  // unit vectors over the joint accelerations, or longer
    }
  }
}

TEST(Projection, NeverMovesTheForceOfASwingFootFromZero) {
  for (const model::ContactMode mode : testing_support::kAllModes) {
    const auto scene = testing_support::random_scene(testing_support::amber3m(), mode, 3, 6);
    const Linearisation model(scene->data, scene->problem, scene->guess);
    for (int k = 0; k < 3; ++k) {
      const InputProjection& p = model.projections[static_cast<std::size_t>(k)];
      const LqStage& lq_stage = model.stages[static_cast<std::size_t>(k)];
      for (int i = kJoints; i < kInputs; ++i) {
        if (mode[(i - kJoints) / 2]) continue;
        EXPECT_EQ(p.u0[i], -scene->guess.u[k][i]);
        EXPECT_TRUE(testing_support::inputs_by_state(lq_stage, p).row(i).isZero(0.0));
        EXPECT_TRUE(testing_support::inputs_by_free(lq_stage, p).row(i).isZero(0.0));
      }
    }
  }
}

/// Legs as straight as `bend_rad` says and side by side. The swing foot's height no longer follows from the
/// joint accelerations, and in double support the feet cannot move apart vertically.
std::unique_ptr<Scene> straight_legs(model::ContactMode mode, double bend_rad) {
  auto scene = testing_support::random_scene(testing_support::amber3m(), mode, kLanes, 7);
  for (int k = 0; k <= kLanes; ++k) {
    double* x = scene->guess.x[k];
    std::fill(x + 2, x + kPositions, 0.0);
    for (const int knee : {4, 6}) x[knee] = bend_rad;
  }
  return scene;
}

TEST(Projection, StaysFiniteAndBoundedWithBothLegsStraightAndFeetTogether) {
  for (const model::ContactMode mode : testing_support::kAllModes) {
    for (const double bend_rad : {0.0, 1e-300, 1e-12, 1e-8, 1e-5, 1e-4, 1e-3, 3e-3, 1e-2}) {
      const auto scene = straight_legs(mode, bend_rad);
      const Linearisation model(scene->data, scene->problem, scene->guess);
      // Residuals reach about 2000 m/s^2 here; the damped inverse is at most 1 / rank_tolerance.
      const double bound = 1e4 / scene->data.equality.rank_tolerance;
      for (int k = 0; k < kLanes; ++k) {
        const InputProjection& p = model.projections[static_cast<std::size_t>(k)];
        const LqStage& lq_stage = model.stages[static_cast<std::size_t>(k)];
        SCOPED_TRACE(testing::Message() << "bend " << bend_rad);
        const auto largest = [](const Eigen::MatrixXd& m) {
          return m.cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
        };
        ASSERT_LT(largest(Eigen::Map<const model::InputVector>(p.u0)), bound);
        ASSERT_LT(largest(testing_support::inputs_by_state(lq_stage, p)), bound);
        ASSERT_LT(largest(testing_support::inputs_by_free(lq_stage, p)), 1e4);
      }
    }
  }
}

TEST(Projection, LetsAConstraintFadeWhereItsRowVanishes) {
  const auto scene = straight_legs({false, true}, 0.0);
  const Linearisation model(scene->data, scene->problem, scene->guess);
  // The row is zero: no step tries to fulfil it, the other inputs stay as small as the stance foot allows.
  for (int k = 0; k < kLanes; ++k) {
    for (int j = 0; j < kJoints; ++j) {
      EXPECT_EQ(model.projections[static_cast<std::size_t>(k)].u0[j], 0.0);
    }
  }
}

TEST(DampedInverse, IsContinuousAtTheToleranceAndZeroAtZero) {
  constexpr double kTolerance = 1e-3;
  const auto inverse = [](double s) {
    return static_cast<double>(detail::damped_inverse(Batch(s), kTolerance)[0]);
  };
  EXPECT_EQ(inverse(0.0), 0.0);
  EXPECT_NEAR(inverse(kTolerance), inverse(std::nextafter(kTolerance, 1.0)), 1e-9);
  EXPECT_NEAR(inverse(-kTolerance), -1.0 / kTolerance, 1e-9);
  EXPECT_EQ(inverse(0.5), 2.0);
  for (double s = -5e-3; s < 5e-3; s += 1e-5) EXPECT_LE(std::abs(inverse(s)), 1.0 / kTolerance + 1e-9);
}

}  // namespace
}  // namespace stilt::ocp
