#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "firmware/configuration/gaits/shipped_gaits.h"
#include "mpc_core/gait/reference.h"
#include "tests/mpc_core/printers.h"
#include "tests/robots.h"

namespace stilt::gait {
namespace {

using model::kFirstJoint;
using model::kJoints;
using model::kPositions;

const GaitLibrary& library() {
  static const auto shipped = [] {
    auto filled = std::make_unique<GaitLibrary>();
    EXPECT_TRUE(gait_files::load_shipped_library("amber3m", *filled));
    return filled;
  }();
  return *shipped;
}

/// Walking under way at a steady speed, the reference around the shipped gaits.
struct Walk {
  GaitParameters gait;
  ReferenceParameters parameters;
  ContactSchedule schedule;
  HeuristicReference heuristic, following;
  double now_s = 0.65;

  explicit Walk(double speed_m_s) {
    gait.single_support_s = library().step_time_s();
    schedule.reset(0.0);
    following.follow(testing_support::amber3m(), &library());
    for (const double time_s : {0.0, now_s}) command(time_s, {GaitKind::walk, speed_m_s}, speed_m_s);
  }

  void command(double time_s, const GaitCommand& command, double speed_m_s) {
    schedule.update(time_s, now_s + 3.0, command, gait, parameters, speed_m_s, true);
    model::StateVector state = model::StateVector::Zero();
    state[0] = 0.4;
    state[model::kPositions] = speed_m_s;
    for (HeuristicReference* reference : {&heuristic, &following}) {
      reference->prepare(testing_support::amber3m().constants, schedule, command, gait, parameters, now_s,
                         state, {0.45, 0.0, 0.3, 0.0}, speed_m_s, 0.0);
    }
  }
};

class FollowGait : public testing::TestWithParam<double> {};

TEST_P(FollowGait, TakesJointsFromTheGaitByTheRolesOfTheLegs) {
  const Walk walk(GetParam());
  for (double t = 0.65; t < 2.5; t += 0.041) {
    const int phase = walk.schedule.index_at(t);
    const ContactPhase& contact = walk.schedule.phase(phase);
    ASSERT_EQ(contact.mode.count(), 1);
    const GaitPoint gait =
        library().motion_at(GetParam(), (t - contact.start_s) / walk.gait.single_support_s);
    const ReferencePoint point = walk.following.evaluate(t, phase);
    const int stance_leg = kFirstJoint + (contact.mode.left ? 0 : 2);
    const int swing_leg = kFirstJoint + (contact.mode.left ? 2 : 0);
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(point.state[stance_leg + i], gait.position[kFirstJoint + i], 1e-9);
      EXPECT_NEAR(point.state[swing_leg + i], gait.position[kFirstJoint + 2 + i], 1e-9);
      EXPECT_NEAR(point.state[kPositions + swing_leg + i], gait.velocity[kFirstJoint + 2 + i], 1e-7);
      EXPECT_NEAR(point.input[stance_leg - kFirstJoint + i], gait.acceleration[kFirstJoint + i], 1e-5);
    }
    EXPECT_NEAR(point.input[kJoints + (contact.mode.left ? 1 : 3)], gait.force_N[1], 1e-6);
    EXPECT_EQ(point.input[kJoints + (contact.mode.left ? 3 : 1)], 0.0);
  }
}

TEST_P(FollowGait, ProgressesWithTheHeuristicBaseUpToWhatAGaitDoesWithinAStep) {
  const Walk walk(GetParam());
  for (double t = 0.65; t < 2.5; t += 0.041) {
    const int phase = walk.schedule.index_at(t);
    const double lead_m =
        walk.following.evaluate(t, phase).state[0] - walk.heuristic.evaluate(t, phase).state[0];
    EXPECT_LT(std::abs(lead_m), 0.01);
  }
  for (int phase = walk.schedule.index_at(1.0); phase < walk.schedule.index_at(2.5); ++phase) {
    const double middle_s = 0.5 * (walk.schedule.phase(phase).start_s + walk.schedule.end_s(phase));
    EXPECT_NEAR(walk.following.evaluate(middle_s, phase).state[0],
                walk.heuristic.evaluate(middle_s, phase).state[0], 1e-9);
  }
}

TEST_P(FollowGait, SwingsTheFootToWhereItStandsNext) {
  const Walk walk(GetParam());
  for (int phase = walk.schedule.index_at(walk.now_s); phase < walk.schedule.index_at(2.5); ++phase) {
    const double end_s = walk.schedule.end_s(phase);
    const ReferencePoint landing = walk.following.evaluate(end_s, phase);
    const ReferencePoint standing = walk.following.evaluate(end_s, phase + 1);
    const int foot = walk.schedule.phase(phase).mode.left ? model::kRight : model::kLeft;
    EXPECT_NEAR(landing.foot_position_W_m[2 * foot], standing.foot_position_W_m[2 * foot], 2e-3);
    EXPECT_NEAR(landing.foot_position_W_m[2 * foot + 1], 0.0, 1e-3);
    EXPECT_LT(landing.foot_velocity_W_m_s[2 * foot + 1], -0.05) << "comes down";
  }
}

TEST_P(FollowGait, LeavesTheFootThatStandsAlreadyWhereItIs) {
  const Walk walk(GetParam());
  const int phase = walk.schedule.index_at(walk.now_s);
  const int stance = walk.schedule.phase(phase).mode.left ? model::kLeft : model::kRight;
  EXPECT_EQ(walk.following.evaluate(walk.now_s, phase).foot_position_W_m[2 * stance],
            walk.heuristic.evaluate(walk.now_s, phase).foot_position_W_m[2 * stance]);
}

/// As a gait lands them the feet would come together, where a stand is no equilibrium.
TEST_P(FollowGait, LandsTheFeetOfAStandWhereTheHeuristicsDo) {
  Walk walk(GetParam());
  walk.command(walk.now_s, {GaitKind::stand, 0.0}, GetParam());
  const int stand = walk.schedule.index_at(walk.now_s + 3.0);
  ASSERT_EQ(walk.schedule.phase(stand).gait, GaitKind::stand);
  for (const int phase : {stand - 2, stand - 1}) {
    const double end_s = walk.schedule.end_s(phase);
    const int foot = walk.schedule.phase(phase).mode.left ? model::kRight : model::kLeft;
    const ReferencePoint landing = walk.following.evaluate(end_s, phase);
    const ReferencePoint heuristic = walk.heuristic.evaluate(end_s, phase);
    EXPECT_EQ(landing.foot_position_W_m[2 * foot], heuristic.foot_position_W_m[2 * foot]);
    EXPECT_NEAR(landing.foot_position_W_m[2 * foot + 1], 0.0, 1e-3) << "the height is the gait's";
  }
}

INSTANTIATE_TEST_SUITE_P(Speeds, FollowGait, testing::Values(-0.4, 0.0, 0.5, 0.73, 1.0));

TEST(FollowGait, StandingKeepsTheHeuristics) {
  HeuristicReference heuristic;
  HeuristicReference following;
  following.follow(testing_support::amber3m(), &library());
  ContactSchedule schedule;
  schedule.reset(0.0);
  for (HeuristicReference* reference : {&heuristic, &following}) {
    reference->prepare(testing_support::amber3m().constants, schedule, {}, {}, {}, 0.0,
                       model::StateVector::Zero(), {0.15, 0.0, -0.15, 0.0}, 0.0, 0.0);
  }
  EXPECT_EQ(heuristic.evaluate(0.3, 0).state, following.evaluate(0.3, 0).state);
  EXPECT_EQ(heuristic.evaluate(0.3, 0).foot_position_W_m, following.evaluate(0.3, 0).foot_position_W_m);
}

}  // namespace
}  // namespace stilt::gait
