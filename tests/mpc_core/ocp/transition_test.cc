#include <gtest/gtest.h>

#include <cmath>

#include "tests/mpc_core/lq/dense_stage.h"
#include "tests/mpc_core/ocp/planning_scene.h"
#include "tests/mpc_core/ocp/scalar_ocp.h"
#include "tests/mpc_core/ocp/zero_padding.h"
#include "tests/robots.h"

namespace stilt::ocp {
namespace {

using model::kStates;
using testing_support::Complex;
using testing_support::Linearisation;
using testing_support::LqStage;
using testing_support::ScalarOcp;
using testing_support::StageVector;

/// One stage, a touch-down of the given feet into a contact mode at a random state.
std::unique_ptr<testing_support::Scene> touchdown_scene(const model::RobotModel& robot,
                                                        model::ContactMode after, bool left, bool right,
                                                        std::uint64_t seed) {
  auto scene = testing_support::random_scene(robot, after, 1, seed);
  Stage& stage = scene->problem.horizon.stage[0];
  stage.kind = StageKind::transition;
  stage.duration_s = 0.0;
  stage.touchdown = {left, right};
  scene->problem.batches = 0;
  scene->problem.transition_batches = 1;
  TransitionBatch& batch = scene->problem.transition_batch[0];
  batch.mode = after;
  batch.touchdown = stage.touchdown;
  batch.lanes = 1;
  batch.weight = Batch([](auto lane) { return lane == 0 ? 1.0 : 0.0; });
  return scene;
}

struct Landing {
  model::ContactMode after;
  bool left;  ///< lands
  bool right;
};

template <class Check>
void for_random_touchdowns(const Check& check) {
  for (const model::RobotModel* robot : {&testing_support::amber3m(), &testing_support::rabbit()}) {
    for (const auto& [after, left, right] : {Landing{{.left = true}, true, false},
                                             {{.right = true}, false, true},
                                             {{.left = true, .right = true}, true, false},
                                             {{.left = true, .right = true}, false, true},
                                             {{.left = true, .right = true}, true, true}}) {
      for (const Transition kind : {Transition::identity, Transition::impact}) {
        for (std::uint64_t seed = 1; seed <= 20; ++seed) {
          SCOPED_TRACE(testing::Message()
                       << robot->constants.name << " L" << left << " R" << right << " of " << after.count()
                       << " " << (kind == Transition::impact ? "impact" : "identity") << " seed " << seed);
          const auto scene = touchdown_scene(*robot, after, left, right, seed);
          scene->data.discretisation.transition = kind;
          check(*scene);
        }
      }
    }
  }
}

TEST(Transition, DerivativesAreThoseOfTheImpactMap) {
  for_random_touchdowns([](const testing_support::Scene& scene) {
    const Linearisation model(scene.data, scene.problem, scene.guess);
    const LqStage& lq_stage = model.stages[0];
    const ScalarOcp scalar(scene.data);
    const Stage& stage = scene.problem.horizon.stage[0];
    const auto after = [&](const auto& z) {
      return scalar.transition(stage, decltype(scalar.step(z, 0.0))(z.template head<kStates>()));
    };
    StageVector<double> z = testing_support::stage_variables(scene.guess, 0);
    const Eigen::MatrixXd expected = testing_support::jacobian(after, z);
    const model::StateVector reached = after(z);
    ASSERT_EQ(lq_stage.free_inputs, 0);
    const auto dynamics = lq::testing::dense_dynamics(lq_stage);
    for (int r = 0; r < kStates; ++r) {
      EXPECT_NEAR(lq_stage.b[r], reached[r] - scene.guess.x[1][r], 1e-11 * (1.0 + std::abs(reached[r])));
      for (int c = 0; c < kStates; ++c) {
        EXPECT_NEAR(dynamics(r, c), expected(r, c), 1e-10 * (1.0 + expected.norm()))
            << "row " << r << " column " << c;
      }
    }
  });
}

TEST(Transition, CostModelIsTheGradientAndTheGaussNewtonHessianOfItsTerms) {
  for_random_touchdowns([](const testing_support::Scene& scene) {
    const Linearisation model(scene.data, scene.problem, scene.guess);
    const LqStage& lq_stage = model.stages[0];
    const Stage& stage = scene.problem.horizon.stage[0];
    const ScalarOcp scalar(scene.data);
    const auto values = [&](const StageVector<Complex>& z) {
      std::vector<Complex> y;
      for (const auto& term :
           scalar.touchdown_terms(stage, testing_support::StateOf<Complex>(z.head<kStates>()))) {
        y.push_back(term.y);
      }
      return y;
    };
    const StageVector<double> z = testing_support::stage_variables(scene.guess, 0);
    const Eigen::MatrixXd rows = testing_support::jacobian(values, z).leftCols<kStates>();
    const auto terms = scalar.touchdown_terms(stage, model::StateVector(z.head<kStates>()));
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(kStates);
    Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(kStates, kStates);
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      const auto& term = terms[static_cast<std::size_t>(i)];
      gradient += term.first() * rows.row(i).transpose();
      expected += term.second() * rows.row(i).transpose() * rows.row(i);
    }
    const Eigen::MatrixXd hessian = lq::testing::dense_hessian(lq_stage).topLeftCorner(kStates, kStates);
    for (int c = 0; c < kStates; ++c)
      EXPECT_NEAR(lq_stage.q[c], gradient[c], 1e-10 * (1.0 + gradient.norm()));
    EXPECT_LE((hessian - expected).norm(), 1e-10 * (1.0 + expected.norm()));
  });
}

TEST(Transition, WritesZeroToThePadding) {
  for_random_touchdowns([](const testing_support::Scene& scene) {
    testing_support::expect_zero_padding({scene.data, scene.problem, scene.guess});
  });
}

TEST(Transition, IdentityLeavesTheStateAlone) {
  const auto scene = touchdown_scene(testing_support::amber3m(), {.left = true}, true, false, 3);
  scene->data.discretisation.transition = Transition::identity;
  const Linearisation model(scene->data, scene->problem, scene->guess);
  EXPECT_TRUE(lq::testing::dense_dynamics(model.stages[0]).isIdentity(0.0));
  for (int c = 0; c < kStates; ++c) {
    EXPECT_EQ(model.stages[0].b[c], scene->guess.x[0][c] - scene->guess.x[1][c]);
  }
}

TEST(Transition, ImpactBringsTheFootToRest) {
  auto scene = touchdown_scene(testing_support::amber3m(), {.right = true}, false, true, 4);
  scene->data.discretisation.transition = Transition::impact;
  const Linearisation model(scene->data, scene->problem, scene->guess);
  model::StateVector after = Eigen::Map<const model::StateVector>(scene->guess.x[1]) +
                             Eigen::Map<const model::StateVector>(model.stages[0].b);
  model::KinematicsTerms<double> feet;
  testing_support::amber3m().kinematics(after.data(), feet);
  EXPECT_NEAR(feet.foot_velocity[2], 0.0, 1e-11);
  EXPECT_NEAR(feet.foot_velocity[3], 0.0, 1e-11);
}

TEST(Transition, AFootThatStandsStaysAtRestWhenTheOtherLands) {
  const auto scene =
      touchdown_scene(testing_support::amber3m(), {.left = true, .right = true}, false, true, 5);
  scene->data.discretisation.transition = Transition::impact;
  const Linearisation model(scene->data, scene->problem, scene->guess);
  const model::StateVector after = Eigen::Map<const model::StateVector>(scene->guess.x[1]) +
                                   Eigen::Map<const model::StateVector>(model.stages[0].b);
  model::KinematicsTerms<double> feet;
  testing_support::amber3m().kinematics(after.data(), feet);
  for (const double velocity : feet.foot_velocity) EXPECT_NEAR(velocity, 0.0, 1e-11);
}

}  // namespace
}  // namespace stilt::ocp
