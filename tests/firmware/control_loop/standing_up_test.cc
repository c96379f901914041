// From damped joints to standing: in which pose it begins, and what of an earlier stance episode counts then.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "tests/firmware/control_loop/rig.h"

namespace stilt::control_loop {
namespace {

using supervisor::FallbackLevel;
using supervisor::Fault;
using supervisor::RequestKind;
using supervisor::State;
using testing::Rig;

class StandingUpTest : public ::testing::Test {
 protected:
  StandingUpTest() {
    rig->configuration.supervisor.damped_before_off_s = 0.02;  // a plan from before it has not ended
    rig->cycle.configure(*rig->robot, rig->configuration, rig->configuration.supervisor);
  }

  std::unique_ptr<Rig> rig = std::make_unique<Rig>();
};

TEST_F(StandingUpTest, WaitsForTheStandingPose) {
  rig->get_ready();
  rig->joints.readings[1].position_rad += 0.3;
  rig->ask(RequestKind::stand);
  rig->run(100);
  EXPECT_EQ(rig->state(), State::ready);
  EXPECT_TRUE(rig->only_damps());
  EXPECT_EQ(rig->take(Event::Kind::waits_for_pose).size(), 1u);
  rig->joints.readings[1].position_rad -= 0.3;
  rig->run(10);
  EXPECT_EQ(rig->state(), State::stand);
}

TEST_F(StandingUpTest, TheEventNamesTheJointFarthestFromThePoseItsAngleAndItsRange) {
  const double margin_rad = rig->configuration.supervisor.stand_pose_margin_rad;
  rig->get_ready();
  const double standing_rad = rig->joints.readings[3].position_rad;
  rig->joints.readings[0].position_rad -= 1.1 * margin_rad;
  rig->joints.readings[3].position_rad += 1.5 * margin_rad;
  rig->ask(RequestKind::stand);
  rig->run(10);
  const std::vector<Event> events = rig->take(Event::Kind::waits_for_pose);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].pose.joint, 3);
  EXPECT_NEAR(events[0].pose.value, standing_rad + 1.5 * margin_rad, 1e-9);
  EXPECT_NEAR(events[0].pose.lowest, standing_rad - margin_rad, 1e-3);
  EXPECT_NEAR(events[0].pose.highest, standing_rad + margin_rad, 1e-3);
}

TEST_F(StandingUpTest, TheEventNamesTheTorsoAndWhatMovesTooFast) {
  rig->get_ready();
  rig->joints.base.pitch_rad = 0.5;
  rig->ask(RequestKind::stand);
  rig->run(10);
  std::vector<Event> events = rig->take(Event::Kind::waits_for_pose);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].pose.joint, PoseMiss::kTorso);
  EXPECT_EQ(events[0].pose.value, 0.5);
  rig->ask(RequestKind::sit);
  rig->run(5);
  rig->joints.base.pitch_rad = 0.0;
  rig->joints.readings[2].velocity_rad_s = -3.0;
  rig->ask(RequestKind::stand);
  rig->run(10);
  events = rig->take(Event::Kind::waits_for_pose);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].pose.joint, 2);
  EXPECT_EQ(events[0].pose.value, -3.0);
  EXPECT_STREQ(events[0].pose.unit, "rad/s");
}

TEST_F(StandingUpTest, WaitsUntilNothingMovesEitherWay) {
  rig->get_ready();
  rig->ask(RequestKind::stand);
  const double fast_rad_s = 1.1 * rig->configuration.supervisor.stand_speed_rad_s;
  for (double* velocity_rad_s :
       {&rig->joints.readings[0].velocity_rad_s, &rig->joints.readings[3].velocity_rad_s,
        &rig->joints.base.pitch_rate_rad_s}) {
    for (const double side : {-1.0, 1.0}) {
      *velocity_rad_s = side * fast_rad_s;
      rig->run(10);
      EXPECT_EQ(rig->state(), State::ready);
    }
    *velocity_rad_s = 0.0;
  }
  rig->run(10);
  EXPECT_EQ(rig->state(), State::stand);
}

TEST_F(StandingUpTest, WaitsForAnUprightTorso) {
  rig->get_ready();
  rig->ask(RequestKind::stand);
  const double margin_rad = rig->configuration.supervisor.stand_pose_margin_rad;
  for (const double side : {-1.0, 1.0}) {
    rig->joints.base.pitch_rad = side * 1.1 * margin_rad;
    rig->run(10);
    EXPECT_EQ(rig->state(), State::ready);
  }
  rig->joints.base.pitch_rad = -0.9 * margin_rad;
  rig->run(10);
  EXPECT_EQ(rig->state(), State::stand);
}

TEST_F(StandingUpTest, EitherFootMayBeAhead) {
  rig->get_ready();
  for (const std::size_t left : {0U, 1U}) {
    std::swap(rig->joints.readings[left].position_rad, rig->joints.readings[left + 2].position_rad);
  }
  ASSERT_GT(std::abs(rig->joints.readings[0].position_rad - rig->joints.readings[2].position_rad),
            rig->configuration.supervisor.stand_pose_margin_rad)
      << "one pose is not near the other";
  rig->ask(RequestKind::stand);
  rig->run(10);
  EXPECT_EQ(rig->state(), State::stand);
}

TEST_F(StandingUpTest, EveryWaitForThePoseIsReported) {
  rig->get_ready();
  rig->joints.readings[1].position_rad += 0.3;
  for (int wait = 0; wait < 2; ++wait) {
    rig->ask(RequestKind::stand);
    rig->run(20);
    EXPECT_EQ(rig->take(Event::Kind::waits_for_pose).size(), 1u) << "wait " << wait;
    rig->ask(RequestKind::sit);
    rig->run(5);
  }
}

TEST_F(StandingUpTest, AWaitForThePoseEndsAndToStandHasToBeAskedForAgain) {
  rig->get_ready();
  rig->joints.readings[1].position_rad += 0.3;
  rig->ask(RequestKind::stand);
  const int wait = static_cast<int>(1000 * rig->configuration.supervisor.stand_wait_s);
  rig->run(wait);
  EXPECT_EQ(rig->take(Event::Kind::stopped_waiting).size(), 0u);
  rig->run(3);
  EXPECT_EQ(rig->take(Event::Kind::stopped_waiting).size(), 1u);
  rig->joints.readings[1].position_rad -= 0.3;
  rig->run(100);
  EXPECT_EQ(rig->state(), State::ready) << "minutes later somebody lifts it into the pose";
  rig->ask(RequestKind::stand);
  rig->run(10);
  EXPECT_EQ(rig->state(), State::stand);
}

TEST_F(StandingUpTest, LeavingTheStandingPoseEndsDampedAndIsReported) {
  rig->get_ready();
  rig->ask(RequestKind::stand);
  rig->run(500);
  ASSERT_EQ(rig->state(), State::stand);
  const supervisor::SupervisorParameters& parameters = rig->configuration.supervisor;
  ASSERT_LT(parameters.stand_pose_margin_rad, 0.9 * parameters.stance_margin_rad);
  for (int step = 1; step <= 21; ++step) {  // no jump of the encoder
    ASSERT_EQ(rig->state(), State::stand) << step - 1 << " of 20 shares of stance_margin_rad off the pose";
    rig->joints.readings[1].position_rad += 0.05 * parameters.stance_margin_rad;
    rig->run(1);
  }
  EXPECT_EQ(rig->state(), State::ready);
  EXPECT_TRUE(rig->only_damps());
  const std::vector<Event> events = rig->take(Event::Kind::lost_stance);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].pose.joint, 1);
  EXPECT_TRUE(rig->decision().latched.empty());
}

TEST_F(StandingUpTest, AStopWhileItStandsUpIsNoLossOfThePose) {
  for (const RequestKind kind : {RequestKind::sit, RequestKind::off, RequestKind::none}) {
    SCOPED_TRACE(static_cast<int>(kind));
    rig = std::make_unique<Rig>();
    rig->get_ready();
    rig->ask(RequestKind::stand);
    rig->run(100);
    ASSERT_EQ(rig->state(), State::stand);
    if (kind == RequestKind::none) {
      rig->command.shut_down = true;
    } else {
      rig->ask(kind);
    }
    rig->run(2);
    EXPECT_EQ(rig->state(), State::ready);
    EXPECT_TRUE(rig->take(Event::Kind::lost_stance).empty());
  }
}

TEST_F(StandingUpTest, APlanFromBeforeTheLastFallIsNotFollowed) {
  rig->stand();
  rig->fall_and_get_ready();
  rig->planning = false;
  rig->ask(RequestKind::stand);
  rig->run(20);
  EXPECT_EQ(rig->state(), State::stand);
  EXPECT_EQ(rig->mail.requests.newest().stance_episode, 2u);
  EXPECT_EQ(rig->level(), FallbackLevel::hold)
      << "the old plan has not ended yet, but belongs to another place";
}

TEST_F(StandingUpTest, TheSolvesBeforeTheLastFallDoNotCount) {
  rig->stand();
  PlanningResult& result = rig->mail.results.writer();
  result.stance_episode = 1;
  result.failures_in_a_row = 10;
  result.solve_ns = 50'000'000;
  rig->mail.results.publish();
  rig->run(1);
  EXPECT_TRUE(rig->decision().present.has(Fault::failed_solves));
  EXPECT_TRUE(rig->decision().present.has(Fault::planner_overrun));
  rig->fall_and_get_ready();
  rig->ask(RequestKind::stand);
  rig->run(20);
  EXPECT_EQ(rig->state(), State::stand);
  EXPECT_TRUE(rig->decision().present.empty());
}

TEST_F(StandingUpTest, TheEstimateBeginsAtTheOriginEveryTime) {
  rig->stand();
  EXPECT_NEAR(rig->record.estimated_state[0], 0.0, 1e-12);
  rig->fall_and_get_ready();
  // Both legs backward: the base is ahead of where it was over the feet of before.
  for (const std::size_t hip : {0U, 2U}) rig->joints.readings[hip].position_rad += 0.1;
  rig->ask(RequestKind::stand);
  for (int tick = 0; tick < 30; ++tick) {
    rig->run(1);
    EXPECT_NEAR(rig->record.estimated_state[0], 0.0, 1e-12) << "tick " << tick;
  }
  EXPECT_EQ(rig->state(), State::stand);
}

}  // namespace
}  // namespace stilt::control_loop
