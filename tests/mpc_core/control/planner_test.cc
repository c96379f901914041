#include "mpc_core/control/planner.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "mpc_core/model/leg_exchange.h"
#include "tests/mpc_core/control/planning.h"
#include "tests/robots.h"

namespace stilt::control {
namespace {

using gait::GaitKind;
using model::kStates;
using model::StateVector;
using sqp::SolveReport;
using sqp::SolveStatus;
using testing_support::kStand;
using testing_support::kWalk;
using testing_support::Planning;
using testing_support::shipped;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<std::byte> bytes_of(const Plan& plan) {
  const auto* data = reinterpret_cast<const std::byte*>(&plan);
  return {data, data + sizeof plan};
}

bool same_bits(const auto& a, const auto& b) {
  return std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

/// Everything that the torque loop uses.
void expect_identical(const Plan& a, const Plan& b) {
  ASSERT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(a.start_time_s, b.start_time_s);
  EXPECT_EQ(a.report.iterations, b.report.iterations);
  EXPECT_EQ(a.report.cost, b.report.cost);
  for (int k = 0; k < a.nodes; ++k) {
    const PlanNode& left = a.node[static_cast<std::size_t>(k)];
    const PlanNode& right = b.node[static_cast<std::size_t>(k)];
    ASSERT_EQ(left.time_s, right.time_s);
    ASSERT_TRUE(same_bits(left.state, right.state)) << "node " << k;
    ASSERT_TRUE(same_bits(left.input, right.input)) << "node " << k;
    ASSERT_TRUE(same_bits(left.gain, right.gain)) << "node " << k;
    ASSERT_TRUE(left.mode == right.mode) << "node " << k;
  }
}

TEST(PlannerSettings, LimitsAreTheRobotsScaledByTheConfiguration) {
  ControllerParameters parameters = shipped();
  parameters.robot.velocity_limit_scale = 0.5;
  parameters.robot.torque_limit_scale = 0.75;
  parameters.robot.no_load_speed_rad_s = 8.0;
  const auto settings = std::make_unique<PlannerSettings>();
  const auto work = std::make_unique<sqp::TerminalCostWorkspace>();
  const model::RobotConstants& robot = testing_support::amber3m().constants;
  ASSERT_EQ(prepare_settings(testing_support::amber3m(), parameters, *work, *settings), ConfigureStatus::ok);
  const ocp::JointLimits& limits = settings->data.limits;
  for (int j = 0; j < model::kJoints; ++j) {
    EXPECT_EQ(limits.velocity_rad_s[j], 0.5 * robot.velocity_limit_rad_s[j]);
    EXPECT_EQ(limits.torque_Nm[j], 0.75 * robot.torque_limit_Nm[j]);
    EXPECT_EQ(limits.torque_speed_slope_Nms_rad[j], 0.75 * robot.torque_limit_Nm[j] / 8.0);
    EXPECT_EQ(limits.position_min_rad[j], robot.position_min_rad[j]);
    EXPECT_EQ(limits.position_max_rad[j], robot.position_max_rad[j]);
  }
}

TEST(PlannerSettings, TheTerminalCostFavoursNeitherLeg) {
  const auto settings = std::make_unique<PlannerSettings>();
  const auto work = std::make_unique<sqp::TerminalCostWorkspace>();
  ASSERT_EQ(prepare_settings(testing_support::amber3m(), shipped(), *work, *settings), ConfigureStatus::ok);
  const auto& weight = settings->data.terminal_weight;
  const auto other = [](int i) {
    const int first = i < model::kPositions ? 0 : model::kPositions;
    return first + model::other_leg(i - first, model::kFirstJoint);
  };
  for (int c = 0; c < kStates; ++c) {
    for (int r = 0; r < kStates; ++r) {
      const double size = std::sqrt(weight[c][c] * weight[r][r]);
      EXPECT_NEAR(weight[c][r], weight[other(c)][other(r)], 1e-9 * size) << r << " " << c;
    }
  }
}

TEST(Planner, RefusesNonFiniteInputAndLeavesThePlanUntouched) {
  Planning planning(shipped());
  planning.advance(kWalk, 50);
  ASSERT_TRUE(planning.solve(kWalk).usable());
  const std::vector<std::byte> before = bytes_of(*planning.plan);
  for (const double value : {kNan, kInfinity, -kInfinity}) {
    for (int i = 0; i < kStates; ++i) {
      StateVector state = planning.state;
      state[i] = value;
      const SolveReport report = planning.planner->plan({planning.time_s, state, kWalk}, *planning.plan);
      EXPECT_EQ(report.status, SolveStatus::not_finite) << "state " << i;
      EXPECT_FALSE(report.usable());
    }
    EXPECT_EQ(planning.planner->plan({value, planning.state, kWalk}, *planning.plan).status,
              SolveStatus::not_finite);
    EXPECT_EQ(planning.solve({GaitKind::walk, value}).status, SolveStatus::not_finite);
  }
  EXPECT_EQ(bytes_of(*planning.plan), before);
}

TEST(Planner, ANonFiniteInputLeavesNoTraceInTheNextPlan) {
  Planning spoiled(shipped());
  Planning clean(shipped());
  spoiled.advance(kWalk, 60);
  clean.advance(kWalk, 60);
  StateVector bad = spoiled.state;
  bad[9] = kNan;
  ASSERT_FALSE(spoiled.planner->plan({spoiled.time_s, bad, kWalk}, *spoiled.plan).usable());
  ASSERT_TRUE(spoiled.solve(kWalk).usable());
  ASSERT_TRUE(clean.solve(kWalk).usable());
  expect_identical(*spoiled.plan, *clean.plan);
}

TEST(Planner, AFailedSolveLeavesThePlanAndTheNextOneStartsAfresh) {
  Planning failing(shipped());
  failing.advance(kStand, 30);
  const std::vector<std::byte> before = bytes_of(*failing.plan);
  StateVector huge = failing.state;
  huge.tail<model::kJoints>().setConstant(1e200);  // finite, but its square is not
  const SolveReport failed = failing.planner->plan({failing.time_s, huge, kWalk}, *failing.plan);
  EXPECT_EQ(failed.status, SolveStatus::not_finite);
  EXPECT_EQ(bytes_of(*failing.plan), before);
  ASSERT_TRUE(failing.solve(kWalk).usable());

  // Nothing but the schedule goes on, and the schedule of a stand is that of a new planner.
  Planning fresh(shipped());
  fresh.time_s = failing.time_s;
  fresh.state = failing.state;
  ASSERT_TRUE(fresh.solve(kWalk).usable());
  expect_identical(*failing.plan, *fresh.plan);
}

TEST(Planner, RefusesAHorizonOverItsCapacity) {
  const double longest_s = ocp::kMaxHorizonIntervals * 0.015;
  ControllerParameters parameters = shipped();
  parameters.discretisation.time_step_s = 0.015;
  parameters.discretisation.horizon_s = longest_s;
  EXPECT_EQ(Planning(parameters).status, ConfigureStatus::ok);
  parameters.discretisation.horizon_s = longest_s + 0.001;
  EXPECT_EQ(Planning(parameters).status, ConfigureStatus::horizon_over_capacity);
  parameters.discretisation.horizon_s = kNan;
  EXPECT_EQ(Planning(parameters).status, ConfigureStatus::horizon_over_capacity);
}

TEST(Planner, RefusesMoreContactSwitchesThanItHolds) {
  ControllerParameters parameters = shipped();
  parameters.discretisation.horizon_s = 2.0;
  parameters.gait.single_support_s = 2.001 / ocp::kMaxSwitches;
  EXPECT_EQ(Planning(parameters).status, ConfigureStatus::ok);
  parameters.gait.single_support_s = 1.999 / ocp::kMaxSwitches;
  EXPECT_EQ(Planning(parameters).status, ConfigureStatus::horizon_over_capacity);

  // With double support every step has two switches: 21 from a switch on, and one after the next short gap.
  constexpr int kMostSteps = ocp::kMaxSwitches / 2;
  parameters.gait.double_support_s = 0.05;
  parameters.gait.single_support_s = (2.0 - 0.049) / kMostSteps - 0.05;
  EXPECT_EQ(Planning(parameters).status, ConfigureStatus::ok);
  parameters.gait.single_support_s = (2.0 - 0.051) / kMostSteps - 0.05;
  EXPECT_EQ(Planning(parameters).status, ConfigureStatus::horizon_over_capacity);
}

TEST(Planner, TheLongestHorizonWithTheMostSwitchesIsPlanned) {
  ControllerParameters parameters = testing_support::with_every_plan(shipped());
  parameters.discretisation.horizon_s = 2.0;
  parameters.gait.single_support_s = 2.001 / ocp::kMaxSwitches;
  Planning planning(parameters);
  for (int cycle = 0; cycle < 60; ++cycle) {
    const SolveReport report = planning.solve(kWalk);
    ASSERT_TRUE(report.usable()) << "cycle " << cycle;
    ASSERT_LE(planning.plan->nodes, kMaxNodes);
    planning.follow();
  }
}

TEST(Planner, NamesWeightsWithoutATerminalCost) {
  ControllerParameters parameters = shipped();
  parameters.cost.contact_force = 0.0;  // forces that cost nothing have no best value
  EXPECT_EQ(Planning(parameters).status, ConfigureStatus::terminal_cost_failed);
  parameters.cost.terminal = 0.0;
  EXPECT_EQ(Planning(parameters).status, ConfigureStatus::ok);
}

TEST(Planner, SameInputsGiveTheSameBits) {
  Planning first(shipped());
  Planning second(shipped());
  first.advance(kWalk, 100);
  second.advance(kWalk, 100);
  expect_identical(*first.plan, *second.plan);
}

TEST(Planner, AfterAResetItPlansLikeANewOne) {
  Planning used(shipped());
  used.advance(kWalk, 100);
  used.planner->reset(0.0);
  Planning fresh(shipped());
  used.time_s = fresh.time_s;
  used.state = fresh.state;
  used.advance(kWalk, 50);
  fresh.advance(kWalk, 50);
  expect_identical(*used.plan, *fresh.plan);
}

TEST(Planner, APlanStatesWhatItIs) {
  Planning planning(shipped());
  for (int cycle = 0; cycle < 150; ++cycle) {
    const SolveReport report = planning.solve(kWalk);
    ASSERT_TRUE(report.usable());
    const Plan& plan = *planning.plan;
    EXPECT_EQ(plan.sequence, cycle);
    EXPECT_EQ(plan.start_time_s, planning.time_s);
    EXPECT_EQ(plan.report.status, report.status);
    EXPECT_EQ(plan.report.iterations, report.iterations);
    ASSERT_GE(plan.nodes, 2);
    ASSERT_LE(plan.nodes, kMaxNodes);
    const auto last = static_cast<std::size_t>(plan.nodes - 1);
    EXPECT_NEAR(plan.node[last].time_s, planning.time_s + planning.parameters.discretisation.horizon_s, 1e-9);
    // The velocities are those of PlanStart.
    EXPECT_LT((plan.node[0].state - planning.state).head<model::kPositions>().cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_GT(plan.phase_end_s, planning.time_s);
    planning.follow();
  }
}

TEST(Planner, NodesAreInOrderAndEverythingInThemIsFinite) {
  Planning planning(shipped());
  for (int cycle = 0; cycle < 150; ++cycle) {
    ASSERT_TRUE(planning.solve(kWalk).usable());
    const Plan& plan = *planning.plan;
    double time_s = planning.time_s;
    for (int k = 0; k < plan.nodes; ++k) {
      const PlanNode& node = plan.node[static_cast<std::size_t>(k)];
      ASSERT_GE(node.time_s, time_s);
      ASSERT_TRUE(node.state.allFinite() && node.input.allFinite() && node.gain.allFinite()) << "node " << k;
      ASSERT_GE(node.mode.count(), 1);
      time_s = node.time_s;
    }
    planning.follow();
  }
}

TEST(Planner, SwingFeetCarryNoForceAndStanceFeetStayOnTheGround) {
  Planning planning(shipped());
  planning.advance(kWalk, 200);
  ASSERT_TRUE(planning.solve(kWalk).usable());
  const Plan& plan = *planning.plan;
  for (int k = 0; k + 1 < plan.nodes; ++k) {
    const PlanNode& node = plan.node[static_cast<std::size_t>(k)];
    if (plan.node[static_cast<std::size_t>(k + 1)].time_s == node.time_s) continue;  // a transition
    model::KinematicsTerms<double> feet;
    testing_support::amber3m().kinematics(node.state.data(), feet);
    for (int foot = 0; foot < model::kFeet; ++foot) {
      const auto force_N = node.input.segment<2>(model::kJoints + 2 * foot);
      if (node.mode[foot]) {
        EXPECT_GT(force_N[1], 0.0) << "node " << k;
        EXPECT_NEAR(feet.foot_position[2 * foot + 1], 0.0, 0.01) << "node " << k;
      } else {
        EXPECT_LT(force_N.cwiseAbs().maxCoeff(), 1e-9) << "node " << k;
      }
    }
  }
}

TEST(Planner, StepsFromAStandAreLedIn) {
  Planning planning(shipped());
  planning.advance(kStand, 30);
  const double commanded_s = planning.time_s;
  while (planning.time_s < commanded_s + 1.0) {
    ASSERT_TRUE(planning.solve(kWalk).usable());
    const bool stands = planning.plan->gait == GaitKind::stand;
    const double lead_s = planning.time_s - commanded_s;
    EXPECT_EQ(stands, lead_s < planning.parameters.gait.switch_lead_s - 1e-6) << lead_s << " s later";
    EXPECT_EQ(planning.plan->node[0].mode.count(), stands ? 2 : 1);
    planning.follow();
  }
}

TEST(Planner, AChangeOfGaitWaitsForTheEndOfTheContactPhase) {
  Planning planning(shipped());
  planning.advance({GaitKind::step, 0.0}, 100);
  ASSERT_TRUE(planning.solve({GaitKind::step, 0.0}).usable());
  ASSERT_EQ(planning.plan->gait, GaitKind::step);
  const double boundary_s = planning.plan->phase_end_s;
  const model::ContactMode mode = planning.plan->node[0].mode;
  while (planning.time_s < boundary_s + 0.1) {
    planning.follow();
    ASSERT_TRUE(planning.solve(kWalk).usable());
    const bool before = planning.time_s < boundary_s - 1e-9;
    EXPECT_EQ(planning.plan->gait, before ? GaitKind::step : GaitKind::walk) << planning.time_s;
    if (before) {
      EXPECT_TRUE(planning.plan->node[0].mode == mode);
      EXPECT_EQ(planning.plan->phase_end_s, boundary_s) << "the step under way keeps its time";
    }
  }
}

TEST(Planner, ComesToAStandOnBothFeet) {
  Planning planning(shipped());
  planning.advance(kWalk, 300);
  planning.advance(kStand, 300);
  ASSERT_TRUE(planning.solve(kStand).usable());
  EXPECT_EQ(planning.plan->gait, GaitKind::stand);
  EXPECT_EQ(planning.plan->node[0].mode.count(), 2);
  EXPECT_LT(planning.state.tail<model::kPositions>().cwiseAbs().maxCoeff(), 0.05);
}

TEST(Planner, ReportsTheIterationLimit) {
  ControllerParameters parameters = testing_support::with_every_plan(shipped());
  parameters.sqp.iterations = 1;
  Planning planning(parameters);
  const SolveReport report = planning.solve(kWalk);
  EXPECT_EQ(report.status, SolveStatus::iteration_limit);
  EXPECT_EQ(report.iterations, 1);
  EXPECT_TRUE(report.usable());
}

TEST(Planner, ReportsConvergence) {
  Planning planning(shipped());
  planning.advance(kWalk, 100);
  const SolveReport report = planning.solve(kWalk);
  EXPECT_EQ(report.status, SolveStatus::converged);
  EXPECT_LT(report.dynamics_defect_max, 1e-3);
}

TEST(Planner, ReportsWeightsThatAreNotConvex) {
  ControllerParameters parameters = shipped();
  parameters.cost.terminal = 0.0;
  parameters.cost.joint_acceleration = -100.0;
  Planning planning(parameters);
  const SolveReport report = planning.solve(kWalk);
  EXPECT_EQ(report.status, SolveStatus::not_convex);
  EXPECT_FALSE(report.usable());
  EXPECT_EQ(planning.plan->nodes, 0) << "no plan yet, and none from this solve";
}

TEST(Planner, ReportsAStepThatTheLineSearchRejects) {
  ControllerParameters parameters = testing_support::with_every_plan(shipped());
  parameters.sqp.filter_violation_max = 0.0;  // with filter_margin = 1 no violation is small enough
  parameters.sqp.filter_margin = 1.0;
  Planning planning(parameters);
  const SolveReport report = planning.solve(kWalk);
  EXPECT_EQ(report.status, SolveStatus::step_rejected);
  EXPECT_EQ(report.line_search_step, 0.0);
  EXPECT_TRUE(report.usable());
}

}  // namespace
}  // namespace stilt::control
