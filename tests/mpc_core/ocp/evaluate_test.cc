#include <gtest/gtest.h>

#include <cmath>

#include "tests/mpc_core/ocp/planning_scene.h"
#include "tests/mpc_core/ocp/scalar_ocp.h"
#include "tests/robots.h"

namespace stilt::ocp {
namespace {

using testing_support::Scene;
using testing_support::SceneOptions;

void expect_same(const Merit& batched, const Merit& scalar) {
  EXPECT_NEAR(batched.cost, scalar.cost, 1e-12 * std::abs(scalar.cost));
  EXPECT_NEAR(batched.violation_squared, scalar.violation_squared, 1e-11 * scalar.violation_squared);
  EXPECT_NEAR(batched.dynamics_defect_max, scalar.dynamics_defect_max,
              1e-11 * (1.0 + scalar.dynamics_defect_max));
  EXPECT_NEAR(batched.equality_violation_max, scalar.equality_violation_max,
              1e-11 * (1.0 + scalar.equality_violation_max));
}

void expect_same(const Scene& scene) {
  const testing_support::ScalarOcp scalar(scene.data);
  expect_same(evaluate(scene.data, scene.problem, scene.guess),
              scalar.evaluate(scene.problem, scene.points, scene.guess));
}

/// Any symmetric matrix will do as a terminal weight.
void set_terminal_weight(ProblemData& data) {
  for (int c = 0; c < model::kStates; ++c) {
    for (int r = 0; r < model::kStates; ++r) {
      data.terminal_weight[c][r] = (r == c ? 30.0 : 0.0) + std::sin(static_cast<double>(r + c));
    }
  }
}

TEST(Evaluate, OfEveryContactModeAgreesWithAScalarEvaluation) {
  for (const model::RobotModel* robot : {&testing_support::amber3m(), &testing_support::rabbit()}) {
    for (const model::ContactMode mode : testing_support::kAllModes) {
      for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        SCOPED_TRACE(testing::Message()
                     << robot->constants.name << " L" << mode.left << " R" << mode.right << " seed " << seed);
        const auto scene = testing_support::random_scene(*robot, mode, 7, seed);
        set_terminal_weight(scene->data);
        scene->data.discretisation.integrator = seed % 2 == 0 ? Integrator::rk2 : Integrator::rk4;
        expect_same(*scene);
      }
    }
  }
}

TEST(Evaluate, CountsNothingForTheUnusedLanesOfABatch) {
  for (int stages = 1; stages <= 2 * kLanes + 1; ++stages) {
    SCOPED_TRACE(testing::Message() << stages << " stages");
    expect_same(*testing_support::random_scene(testing_support::amber3m(), {true, false}, stages, 31));
  }
}

TEST(Evaluate, OfAWholeWalkingHorizonAgreesWithAScalarEvaluation) {
  for (const double double_support_s : {0.0, 0.06}) {
    for (const Transition transition : {Transition::identity, Transition::impact}) {
      for (const double time_s : {0.1, 0.31, 0.55, 0.69, 1.2}) {
        SCOPED_TRACE(testing::Message() << "double support " << double_support_s << " at " << time_s);
        SceneOptions options;
        options.gait.double_support_s = double_support_s;
        options.transition = transition;
        options.time_s = time_s;
        options.horizon_s = 2.0;
        const auto scene = testing_support::walking_scene(options);
        set_terminal_weight(scene->data);
        testing_support::disturb(scene->guess, scene->problem.horizon.stages, 0.3, 41);
        expect_same(*scene);
      }
    }
  }
}

TEST(Evaluate, WeighsTheRunningCostByItsDurationAndTheTerminalCostByOne) {
  const auto scene = testing_support::random_scene(testing_support::amber3m(), {true, true}, 1, 51);
  const double once = evaluate(scene->data, scene->problem, scene->guess).cost;
  scene->problem.batch[0].duration *= 2.0;
  EXPECT_NEAR(evaluate(scene->data, scene->problem, scene->guess).cost, 2.0 * once, 1e-12 * std::abs(once));
  set_terminal_weight(scene->data);
  const double terminal =
      testing_support::ScalarOcp(scene->data).terminal_cost(scene->problem, scene->guess.x[1]);
  EXPECT_NEAR(evaluate(scene->data, scene->problem, scene->guess).cost, 2.0 * once + terminal,
              1e-12 * std::abs(once));
}

TEST(Evaluate, ShowsWhatIsNotFinite) {
  for (const double bad : {std::nan(""), HUGE_VAL}) {
    auto scene = testing_support::random_scene(testing_support::amber3m(), {true, false}, 3, 61);
    scene->guess.u[1][5] = bad;
    EXPECT_FALSE(std::isfinite(evaluate(scene->data, scene->problem, scene->guess).cost));
    scene = testing_support::random_scene(testing_support::amber3m(), {true, false}, 3, 61);
    scene->guess.x[2][3] = bad;
    const Merit merit = evaluate(scene->data, scene->problem, scene->guess);
    EXPECT_FALSE(std::isfinite(merit.cost) && std::isfinite(merit.violation_squared));
  }
}

}  // namespace
}  // namespace stilt::ocp
