#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "mpc_core/control/planner.h"
#include "tests/mpc_core/control/planning.h"
#include "tests/robots.h"

/// Plans that violate the bounds of SqpParameters: docs/decisions/0022-feasible-plans.md.
namespace stilt::control {
namespace {

using sqp::SolveReport;
using sqp::SolveStatus;
using testing_support::kStand;
using testing_support::kWalk;
using testing_support::Planning;
using testing_support::shipped;

/// No plan of these settings is feasible.
std::unique_ptr<PlannerSettings> settings_without_feasible_plans() {
  ControllerParameters parameters = shipped();
  parameters.sqp.plan_cone_violation_max_N = -1.0;
  auto settings = std::make_unique<PlannerSettings>();
  const auto work = std::make_unique<sqp::TerminalCostWorkspace>();
  EXPECT_EQ(prepare_settings(testing_support::amber3m(), parameters, *work, *settings), ConfigureStatus::ok);
  return settings;
}

TEST(InfeasiblePlan, IsNotUsedAndTheNextSolveStartsCold) {
  Planning planning(shipped());
  planning.advance(kStand, 30);
  const Plan before = *planning.plan;
  planning.planner->adopt(*settings_without_feasible_plans());
  EXPECT_EQ(planning.solve(kStand).status, SolveStatus::infeasible);
  EXPECT_EQ(planning.plan->sequence, before.sequence);
  EXPECT_EQ(planning.plan->start_time_s, before.start_time_s);
  EXPECT_EQ(planning.plan->node[1].input, before.node[1].input);

  // Nothing but the schedule goes on, and the schedule of a stand is that of a new planner.
  ASSERT_EQ(planning.planner->configure(testing_support::amber3m(), shipped()), ConfigureStatus::ok);
  const SolveReport next = planning.solve(kWalk);
  Planning fresh(shipped());
  fresh.time_s = planning.time_s;
  fresh.state = planning.state;
  const SolveReport cold = fresh.solve(kWalk);
  ASSERT_TRUE(next.usable() && cold.usable());
  EXPECT_EQ(next.iterations, cold.iterations);
  EXPECT_EQ(next.cost, cold.cost);
}

TEST(InfeasiblePlan, OfAColdStartIsContinuedOnce) {
  Planning planning(shipped());
  planning.planner->adopt(*settings_without_feasible_plans());
  const SolveReport cold = planning.solve(kWalk);
  const SolveReport continued = planning.solve(kWalk);
  const SolveReport cold_again = planning.solve(kWalk);
  EXPECT_EQ(continued.status, SolveStatus::infeasible);
  EXPECT_LT(continued.iterations, cold.iterations);
  EXPECT_EQ(cold_again.iterations, cold.iterations);
  EXPECT_EQ(cold_again.cost, cold.cost);
  EXPECT_EQ(planning.plan->nodes, 0);
}

TEST(InfeasiblePlan, HasDefectsOrForcesBeyondTheirBounds) {
  const auto report_with = [](double defect_max, double cone_violation_max_N, double pulling_force_max_N) {
    ControllerParameters parameters = shipped();
    parameters.sqp.iterations = 1;  // far from converged
    parameters.sqp.plan_defect_max = defect_max;
    parameters.sqp.plan_cone_violation_max_N = cone_violation_max_N;
    parameters.sqp.plan_pulling_force_max_N = pulling_force_max_N;
    return Planning(parameters).solve(kWalk);
  };
  const SolveReport report = report_with(1e6, 1e6, 1e6);
  ASSERT_EQ(report.status, SolveStatus::iteration_limit);
  const double defect = report.dynamics_defect_max;
  const double cone_N = report.violations.friction_cone_violation_max_N;
  const double pull_N = report.violations.pulling_force_max_N;
  ASSERT_GT(defect, 0.0);
  EXPECT_EQ(report_with(defect, cone_N, pull_N).status, SolveStatus::iteration_limit);
  EXPECT_EQ(report_with(0.99 * defect, cone_N, pull_N).status, SolveStatus::infeasible);
  EXPECT_EQ(report_with(defect, cone_N - 0.01, pull_N).status, SolveStatus::infeasible);
  EXPECT_EQ(report_with(defect, cone_N, pull_N - 0.01).status, SolveStatus::infeasible);
}

}  // namespace
}  // namespace stilt::control
