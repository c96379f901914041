#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <memory>

#include "mpc_core/sqp/sqp.h"
#include "mpc_core/sqp/terminal_cost.h"
#include "tests/mpc_core/sqp/planning_nlp.h"
#include "tests/robots.h"

namespace stilt::sqp {
namespace {

using model::kStates;
using nonlinear_program::IpoptSolution;
using testing_support::PlanningNlp;
using testing_support::Scene;
using testing_support::SceneOptions;

struct Case {
  const char* name;
  SceneOptions options;
};

std::vector<Case> cases() {
  std::vector<Case> all{{"walk_through_a_touch_down", {}},
                        {"walk_with_double_support", {}},
                        {"impact_map", {}},
                        {"rk4_backward_step", {}},
                        {"rabbit", {}}};
  all[1].options.gait.double_support_s = 0.06;
  all[1].options.time_s = 0.5;
  all[2].options.transition = ocp::Transition::impact;
  all[3].options.integrator = ocp::Integrator::rk4;
  all[3].options.command.speed_m_s = -0.3;
  all[3].options.time_s = 0.75;
  all[4].options.robot = &testing_support::rabbit();
  all[4].options.reference.base_height_m = 0.72;  // its legs are 0.8 m long
  return all;
}

std::unique_ptr<Scene> make_scene(const SceneOptions& options) {
  auto scene = testing_support::walking_scene(options);
  const auto work = std::make_unique<TerminalCostWorkspace>();
  const model::StateVector standing = gait::standing_state(
      options.robot->constants, options.reference.base_height_m, 0.0, options.gait.stand_half_width_m, true);
  EXPECT_TRUE(set_terminal_cost(scene->data, standing, *work));
  return scene;
}

/// The SQP run until it can do no better.
SolveReport solve_on(const Scene& scene, ocp::Trajectory& iterate) {
  SqpParameters parameters;
  parameters.iterations = 200;
  parameters.cost_tolerance = 0.0;
  parameters.step_tolerance = 1e-9;
  return std::make_unique<Sqp>()->solve(scene.data, scene.problem, parameters, iterate);
}

SolveReport solve_tightly(const Scene& scene, ocp::Trajectory& iterate) {
  iterate = scene.guess;
  return solve_on(scene, iterate);
}

class AgainstIpopt : public testing::TestWithParam<Case> {};

TEST_P(AgainstIpopt, TheSqpFindsTheSameOptimum) {
  const auto scene = make_scene(GetParam().options);
  const PlanningNlp nlp(*scene);
  const auto iterate = std::make_unique<ocp::Trajectory>();
  const SolveReport report = solve_tightly(*scene, *iterate);
  const IpoptSolution ipopt =
      nonlinear_program::solve(nlp, nlp.pack(scene->guess), {.tolerance = 1e-10, .iterations_max = 100});
  ASSERT_TRUE(ipopt.solved) << ipopt.status;
  RecordProperty("sqp_iterations", report.iterations);
  RecordProperty("ipopt_iterations", ipopt.iterations);
  // It can do no better: as many iterations again gain nothing. What a step may gain is below the rounding of
  // the cost, so that some solves end by their number of iterations.
  const auto further = std::make_unique<ocp::Trajectory>(*iterate);
  EXPECT_NEAR(solve_on(*scene, *further).cost, report.cost, 1e-12 * std::abs(report.cost));
  EXPECT_NEAR(report.cost, ipopt.cost, 1e-8 * std::abs(ipopt.cost));
  const auto other = std::make_unique<ocp::Trajectory>();
  nlp.unpack(ipopt.v, *other);
  for (int k = 0; k <= scene->problem.horizon.stages; ++k) {
    for (int i = 0; i < kStates; ++i) ASSERT_NEAR(iterate->x[k][i], other->x[k][i], 1e-6) << "node " << k;
    if (k == scene->problem.horizon.stages) break;
    for (int i = 0; i < model::kInputs; ++i) {
      ASSERT_NEAR(iterate->u[k][i], other->u[k][i], 1e-5 * (1.0 + std::abs(other->u[k][i]))) << "stage " << k;
    }
  }
}

TEST_P(AgainstIpopt, TheSqpEndsAtAKktPoint) {
  const auto scene = make_scene(GetParam().options);
  const PlanningNlp nlp(*scene);
  const auto iterate = std::make_unique<ocp::Trajectory>();
  const SolveReport report = solve_tightly(*scene, *iterate);
  const Eigen::VectorXd v = nlp.pack(*iterate);
  EXPECT_LT(nlp.constraints(v).lpNorm<Eigen::Infinity>(), 1e-8);
  EXPECT_NEAR(nlp.objective(v), report.cost, 1e-11 * std::abs(report.cost));
  // The gradient must lie in the span of the constraints' gradients; multipliers by least squares.
  const Eigen::VectorXd gradient = nlp.gradient(v);
  Eigen::MatrixXd transposed = Eigen::MatrixXd::Zero(nlp.variable_count(), nlp.constraint_count());
  for (const auto& [row, column, value] : nlp.jacobian(v)) transposed(column, row) += value;
  const Eigen::VectorXd multipliers = transposed.householderQr().solve(-gradient);
  EXPECT_LT((gradient + transposed * multipliers).lpNorm<Eigen::Infinity>(),
            1e-6 * gradient.lpNorm<Eigen::Infinity>());
}

INSTANTIATE_TEST_SUITE_P(Walking, AgainstIpopt, testing::ValuesIn(cases()),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST(PlanningNlp, DerivativesAreDifferencesOfTheValues) {
  const auto scene = make_scene({});
  testing_support::disturb(scene->guess, scene->problem.horizon.stages, 0.1, 3);
  const PlanningNlp nlp(*scene);
  const Eigen::VectorXd v = nlp.pack(scene->guess);
  const Eigen::VectorXd direction = Eigen::VectorXd::NullaryExpr(
      nlp.variable_count(), [](Eigen::Index i) { return std::sin(0.7 * static_cast<double>(i) + 0.3); });
  constexpr double kStep = 1e-5;
  const double slope =
      (nlp.objective(v + kStep * direction) - nlp.objective(v - kStep * direction)) / (2.0 * kStep);
  EXPECT_NEAR(nlp.gradient(v).dot(direction), slope, 1e-6 * (1.0 + std::abs(slope)));
  Eigen::VectorXd product = Eigen::VectorXd::Zero(nlp.constraint_count());
  for (const auto& [row, column, value] : nlp.jacobian(v)) product[row] += value * direction[column];
  const Eigen::VectorXd difference =
      (nlp.constraints(v + kStep * direction) - nlp.constraints(v - kStep * direction)) / (2.0 * kStep);
  EXPECT_LT((product - difference).norm(), 1e-6 * difference.norm());
}

}  // namespace
}  // namespace stilt::sqp
