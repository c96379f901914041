#include "host_tools/simulation/robot_on_bus/gantry.h"

#include <gtest/gtest.h>

namespace stilt::robot_on_bus {
namespace {

constexpr double kWeight_N = 200.0;
constexpr double kTick_s = 0.001;

model::StateVector standing() {
  model::StateVector state = model::StateVector::Zero();
  state[1] = 0.8;
  state.segment<4>(model::kFirstJoint) << -0.5, 0.7, -0.2, 0.6;
  return state;
}

Gantry gantry() { return {GantryParameters{}, standing(), kWeight_N}; }

void elapse(Gantry& gantry, const model::StateVector& state, bool torque_on, double duration_s) {
  for (int i = 0; i < static_cast<int>(duration_s / kTick_s + 0.5); ++i) {
    gantry.elapse(state, torque_on, kTick_s);
  }
}

/// A hip so high that the rope is slack.
model::StateVector carried() {
  model::StateVector state = standing();
  state[1] += 0.05;
  return state;
}

TEST(Gantry, TheHangingRobotIsInEquilibriumJustAboveTheGround) {
  const Gantry stand = gantry();
  const model::StateVector hanging = stand.hanging();
  EXPECT_DOUBLE_EQ(hanging[1], 0.805);
  model::PositionVector weight = model::PositionVector::Zero();
  weight[1] = kWeight_N;
  EXPECT_TRUE(stand.force(hanging).isApprox(weight));
}

TEST(Gantry, TheRopeOnlyPulls) {
  const Gantry stand = gantry();
  EXPECT_EQ(stand.force(carried())[1], 0.0);
}

TEST(Gantry, TheLegRestsAreTooWeakToStandOn) {
  const Gantry stand = gantry();
  model::StateVector bent = stand.hanging();
  bent[model::kFirstJoint] += 1.0;
  EXPECT_EQ(stand.force(bent)[model::kFirstJoint], -GantryParameters{}.rest_limit_Nm);
}

TEST(Gantry, ARobotWithoutTorqueIsHeldEvenWhenTheRopeIsSlack) {
  Gantry stand = gantry();
  elapse(stand, carried(), false, 60.0);
  EXPECT_EQ(stand.state(), GantryState::holding);
  EXPECT_EQ(stand.releases(), 0);
}

TEST(Gantry, ARobotThatCarriesItselfIsReleased) {
  Gantry stand = gantry();
  elapse(stand, carried(), true, 0.25);
  EXPECT_EQ(stand.state(), GantryState::lowering) << "not before it has carried itself for 0.3 s";
  elapse(stand, carried(), true, 0.1);
  EXPECT_EQ(stand.state(), GantryState::releasing);
  elapse(stand, carried(), true, 0.2);
  EXPECT_EQ(stand.state(), GantryState::off);
  EXPECT_EQ(stand.releases(), 1);
  EXPECT_TRUE(stand.force(standing()).isZero());
}

TEST(Gantry, AShortReliefOfTheRopeIsNotEnough) {
  Gantry stand = gantry();
  model::StateVector sunk = standing();
  sunk[1] -= 0.1;
  for (int i = 0; i < 10; ++i) {
    elapse(stand, carried(), true, 0.25);
    elapse(stand, sunk, true, 0.01);
  }
  EXPECT_EQ(stand.releases(), 0);
}

TEST(Gantry, ItReleasesWithoutAJolt) {
  Gantry stand = gantry();
  model::StateVector leaning = carried();
  leaning[model::kFirstAngle] = 0.05;
  elapse(stand, leaning, true, 0.32);
  double before_Nm = stand.force(leaning)[model::kFirstAngle];
  const double whole_Nm = 0.05 * GantryParameters{}.pitch_stiffness_Nm_rad;
  const double step_Nm = 1.01 * whole_Nm * kTick_s / GantryParameters{}.release_s;
  while (stand.state() != GantryState::off) {
    stand.elapse(leaning, true, kTick_s);
    const double now_Nm = stand.force(leaning)[model::kFirstAngle];
    ASSERT_LE(std::abs(now_Nm - before_Nm), step_Nm);
    before_Nm = now_Nm;
  }
  EXPECT_EQ(before_Nm, 0.0);
}

TEST(Gantry, TheRopeIsTakenInAgainWhenTheMotorsGiveUp) {
  Gantry stand = gantry();
  const model::StateVector hanging = stand.hanging();
  elapse(stand, hanging, true, 0.5);
  EXPECT_EQ(stand.state(), GantryState::lowering);
  EXPECT_LT(stand.force(hanging)[1], kWeight_N);
  elapse(stand, hanging, false, 5.0);
  EXPECT_EQ(stand.state(), GantryState::holding);
  EXPECT_DOUBLE_EQ(stand.force(hanging)[1], kWeight_N);
}

TEST(Gantry, TheRopeIsPaidOutAtItsSpeedAndOnlySoFar) {
  Gantry stand = gantry();
  const GantryParameters parameters;
  model::StateVector sunk = stand.hanging();  // as low as the rope ends, so it carries to the end
  sunk[1] -= parameters.lowering_limit_m;
  model::StateVector higher = stand.hanging();
  higher[1] -= 0.01;
  elapse(stand, sunk, true, parameters.torque_on_s);
  const double before_N = stand.force(higher)[1];
  elapse(stand, sunk, true, 0.01);
  EXPECT_NEAR(before_N - stand.force(higher)[1],
              0.01 * parameters.lowering_speed_m_s * parameters.rope_stiffness_N_m, 1e-6);
  elapse(stand, sunk, true, 100.0);
  EXPECT_EQ(stand.state(), GantryState::lowering);
  EXPECT_NEAR(stand.force(sunk)[1], kWeight_N, 1e-6);
}

/// Released, and fallen with straight legs.
model::StateVector fall(Gantry& gantry) {
  elapse(gantry, carried(), true, 1.0);
  EXPECT_EQ(gantry.state(), GantryState::off);
  model::StateVector fallen = model::StateVector::Zero();
  fallen.head<model::kFirstJoint>() << 3.0, 0.3, 1.1;
  gantry.take(fallen);
  return fallen;
}

/// A pose from which feet do not reach the ground at the height of hanging.
model::StateVector bent() {
  model::StateVector state = standing();
  state.head<model::kFirstJoint>() << 3.0, 0.805 + GantryParameters{}.lifting_clearance_m, 0.0;
  state.segment<4>(model::kFirstJoint) << -0.7, 1.1, -0.4, 1.0;
  return state;
}

TEST(Gantry, AFallenRobotIsLiftedToWhereItHangs) {
  Gantry stand = gantry();
  const model::StateVector fallen = fall(stand);
  EXPECT_EQ(stand.state(), GantryState::lifting);
  EXPECT_NEAR(stand.force(fallen)[2], 0.0, 1e-9) << "no jerk when it is taken";
  elapse(stand, bent(), false, 10.0);
  EXPECT_EQ(stand.state(), GantryState::holding);
  model::StateVector hanging = stand.hanging();
  hanging[0] = 3.0;
  model::PositionVector weight = model::PositionVector::Zero();
  weight[1] = kWeight_N;
  EXPECT_LT((stand.force(hanging) - weight).cwiseAbs().maxCoeff(), 1e-9) << "it hangs where it fell";
}

TEST(Gantry, ItLetsAFallenRobotDownWhenItsLegsAreBentAndNotBefore) {
  Gantry stand = gantry();
  const model::StateVector fallen = fall(stand);
  elapse(stand, fallen, true, 10.0);
  EXPECT_EQ(stand.state(), GantryState::lifting);
  EXPECT_NEAR(stand.force(bent())[1], kWeight_N, 1e-6) << "it waits clear of the ground";
  EXPECT_GT(stand.force(fallen)[model::kFirstJoint + 1], 0.0) << "and the rests bend the knees";
  elapse(stand, bent(), true, 0.002);
  EXPECT_EQ(stand.state(), GantryState::settling);
  model::StateVector let_down = bent();
  let_down[1] = 0.805;
  elapse(stand, let_down, true, 0.8);
  EXPECT_EQ(stand.state(), GantryState::settling);
  EXPECT_NEAR(stand.force(let_down)[1], kWeight_N, 1e-6);
  EXPECT_LT(stand.force(let_down)[model::kFirstJoint + 1], 0.0) << "then the legs go into the pose";
}

}  // namespace
}  // namespace stilt::robot_on_bus
