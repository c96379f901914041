#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tests/mpc_core/control/planning.h"
#include "tests/robots.h"

/// The state from which a plan starts.
namespace stilt::control {
namespace {

using model::kPositions;
using model::PositionVector;
using model::StateVector;
using testing_support::kStand;
using testing_support::kWalk;
using testing_support::Planning;
using testing_support::shipped;

/// The velocities differ from the plan before, as after a push.
StateVector pushed(const StateVector& state) {
  StateVector result = state;
  result[kPositions] += 0.3;
  result[kPositions + 1] += 0.4;
  result[kPositions + 4] -= 0.5;
  return result;
}

using FootRows = Eigen::Matrix<double, 2, kPositions, Eigen::RowMajor>;

FootRows foot_rows(const StateVector& state, int foot) {
  model::KinematicsTerms<double> feet;
  testing_support::amber3m().kinematics(state.data(), feet);
  return Eigen::Map<const FootRows>(feet.foot_jacobian[2 * foot]);
}

/// d'Alembert: the jump of the momentum does no work on any motion that keeps the foot at rest.
double work_on_motions_of_the_others(const StateVector& before, const StateVector& after, int foot) {
  model::MassMatrixTerms<double> terms;
  const model::RobotModel& robot = testing_support::amber3m();
  robot.mass_matrix(before.data(), robot.constants.joint_parameters, terms);
  using Square = Eigen::Matrix<double, kPositions, kPositions, Eigen::RowMajor>;
  const PositionVector jump =
      Eigen::Map<const Square>(terms.mass_matrix[0]) * (after.tail<kPositions>() - before.tail<kPositions>());
  const Eigen::MatrixXd free = Eigen::FullPivLU<Eigen::MatrixXd>(foot_rows(before, foot)).kernel();
  return (free.transpose() * jump).lpNorm<Eigen::Infinity>();
}

TEST(PlanStart, IsTheStateAfterAnInelasticContactOfTheStanceFoot) {
  Planning planning(testing_support::with_every_plan(shipped()));
  planning.advance(kWalk, 40);
  for (int cycle = 0; cycle < 60; ++cycle) {
    SCOPED_TRACE(testing::Message() << "cycle " << cycle);
    const StateVector measured = pushed(planning.state);
    planning.state = measured;
    ASSERT_TRUE(planning.solve(kWalk).usable());
    const PlanNode& first = planning.plan->node[0];
    ASSERT_EQ(first.mode.count(), 1);
    const int foot = first.mode.left ? model::kLeft : model::kRight;
    EXPECT_EQ(first.state.head<kPositions>(), measured.head<kPositions>());
    if (planning.plan->node[1].time_s > first.time_s) {
      EXPECT_LE((foot_rows(measured, foot) * first.state.tail<kPositions>()).norm(), 1e-9);
      EXPECT_LE(work_on_motions_of_the_others(measured, first.state, foot), 1e-9);
      EXPECT_GT((foot_rows(measured, foot) * measured.tail<kPositions>()).norm(), 0.1);
    } else {  // a touch-down at the start: the plan has the impact itself
      EXPECT_EQ(first.state, measured);
    }
    planning.follow();
    if (HasFailure()) return;
  }
}

TEST(PlanStart, OfAStandIsTheMeasuredState) {
  Planning planning(shipped());
  planning.advance(kStand, 5);
  const StateVector measured = pushed(planning.state);
  planning.state = measured;
  ASSERT_TRUE(planning.solve(kStand).usable());
  EXPECT_EQ(planning.plan->node[0].state, measured);
}

}  // namespace
}  // namespace stilt::control
