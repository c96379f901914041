#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "firmware/configuration/gaits/shipped_gaits.h"
#include "tests/firmware/control_loop/rig.h"

/// Every fallback level, reached through the ticks, and the commands there.
namespace stilt::control_loop {
namespace {

using supervisor::FallbackLevel;
using supervisor::RequestKind;
using supervisor::State;

/// From the last plan on: stale after 0.25 s, and then a step of 0.25 s and both feet for 0.05 s.
constexpr int kTicksToTheGait = 560;
/// The joints of the rig rest, and the gait leads them from there.
constexpr int kTicksToLeaveRest = 60;

class FallbackTest : public testing::RigTest {};

TEST_F(FallbackTest, NewPlan) {
  rig->stand();
  EXPECT_EQ(rig->level(), FallbackLevel::plan);
}

TEST_F(FallbackTest, OlderPlanWithItsFeedbackGains) {
  rig->stand();
  rig->planning = false;
  rig->joints.base.pitch_rad = 0.05;  // off the plan, so that feedback has something to do
  rig->run(static_cast<int>(1000 * rig->configuration.supervisor.plan_feedback_after_s) + 15);
  ASSERT_EQ(rig->level(), FallbackLevel::plan_feedback);
  control::SensorReading reading;
  reading.time_s = rig->cycle.time_s();
  reading.joint_position_rad = rig->standing.segment<model::kJoints>(model::kFirstJoint);
  reading.base_pitch_rad = 0.05;
  const model::StateVector estimate =
      Eigen::Map<const model::StateVector>(rig->record.estimated_state.data());
  const control::PlanPoint point = control::interpolate(rig->mail.plans.newest(), reading.time_s);
  for (const bool gains : {true, false}) {
    control::ControllerParameters parameters = rig->configuration;
    parameters.torque_law.use_feedback_gains = gains;
    control::TorqueLaw law;
    law.configure(*rig->robot, parameters);
    const double torque_Nm = law.follow(reading, estimate, point).torque_Nm[1];
    EXPECT_EQ(torque_Nm == rig->joints.commands[1].torque_Nm, gains)
        << torque_Nm << " and " << rig->joints.commands[1].torque_Nm;
  }
}

TEST_F(FallbackTest, HoldWhileRepliesAreMissedAndBackToThePlan) {
  rig->stand();
  const double pose_rad = rig->joints.readings[1].position_rad;
  rig->joints.silent = true;
  rig->run(5);
  EXPECT_EQ(rig->level(), FallbackLevel::hold);
  EXPECT_EQ(rig->joints.commands[1].position_rad, pose_rad);
  EXPECT_GT(rig->joints.commands[1].kp_Nm_rad, 0);
  EXPECT_NE(rig->joints.commands[1].torque_Nm, 0) << "the torque of the plan fades";
  rig->joints.silent = false;
  rig->run(2);
  EXPECT_EQ(rig->level(), FallbackLevel::plan);
}

class GaitLevelTest : public FallbackTest {
 protected:
  GaitLevelTest() : library(std::make_unique<gait::GaitLibrary>()) {
    EXPECT_TRUE(gait_files::load_shipped_library("amber3m", *library));
    rig->cycle.track_without_plan(*rig->robot, rig->configuration, *library);
  }

  /// Walking, without plans since these ticks.
  void walk_on_without_plans(double speed_m_s, int ticks) {
    rig->stand();
    rig->ask(RequestKind::walk, speed_m_s);
    rig->run(2000);  // joints that stand still; the plan steps all the same
    ASSERT_EQ(rig->state(), State::walk);
    ASSERT_EQ(rig->level(), FallbackLevel::plan);
    rig->planning = false;
    rig->run(ticks);
  }

  /// Stepping, to select the gait at the first touch-down after a second.
  void step_towards_a_selected_gait() {
    rig->configuration.supervisor.select_gait = true;
    rig->configuration.supervisor.select_gait_after_s = 1.0;
    rig->cycle.configure(*rig->robot, rig->configuration, rig->configuration.supervisor);
    rig->cycle.track_without_plan(*rig->robot, rig->configuration, *library);
    rig->stand();
    rig->ask(RequestKind::step);
  }

  std::unique_ptr<gait::GaitLibrary> library;
};

TEST_F(GaitLevelTest, TracksAGaitWhenThePlannerStopsWhileItWalks) {
  walk_on_without_plans(0.3, kTicksToTheGait);
  EXPECT_EQ(rig->state(), State::walk);
  EXPECT_EQ(rig->level(), FallbackLevel::gait);
  EXPECT_TRUE(rig->decision().present.has(supervisor::Fault::plan_missing));
  EXPECT_TRUE(rig->decision().latched.empty());
  for (const hal::JointCommand& command : rig->joints.commands) {
    EXPECT_EQ(command.kp_Nm_rad, 0) << "the torque is computed here";
    EXPECT_LE(std::abs(command.torque_Nm), 80);
  }
  const auto most = std::ranges::max_element(
      rig->joints.commands, {}, [](const hal::JointCommand& command) { return std::abs(command.torque_Nm); });
  EXPECT_GT(std::abs(most->torque_Nm), 1);
}

TEST_F(GaitLevelTest, IsSelectedOnPurposeAtTheFirstTouchDownAfterItsTimeUntilTheRobotStands) {
  step_towards_a_selected_gait();
  rig->run(1000);
  EXPECT_EQ(rig->level(), FallbackLevel::plan) << "not before";
  rig->run(700);
  EXPECT_EQ(rig->level(), FallbackLevel::gait);
  EXPECT_EQ(rig->record.plan_sequence, -1);
  EXPECT_TRUE(rig->decision().present.empty()) << "it is no fault";
  rig->ask(RequestKind::stand);
  rig->run(static_cast<int>(1000 * rig->configuration.supervisor.slow_down_s) + 100);
  EXPECT_EQ(rig->state(), State::stand);
  EXPECT_EQ(rig->level(), FallbackLevel::plan);
  rig->ask(RequestKind::step);
  rig->run(500);
  EXPECT_EQ(rig->level(), FallbackLevel::plan) << "it counts anew";
  rig->run(1200);
  EXPECT_EQ(rig->level(), FallbackLevel::gait);
}

TEST_F(GaitLevelTest, WithoutPlansInDoubleSupportThereIsNoGaitToGoOnWith) {
  walk_on_without_plans(0.3, 0);
  rig->plan_once_more([](control::Plan& plan) {
    for (control::PlanNode& node : plan.node) node.mode = {true, true};
  });
  rig->run(300);
  EXPECT_EQ(rig->level(), FallbackLevel::sit);
  EXPECT_EQ(std::ranges::find(rig->levels, FallbackLevel::gait), rig->levels.end());
}

TEST_F(GaitLevelTest, APlanIsFollowedAgainOnlyWithTheFootOfTheGaitOnTheGround) {
  walk_on_without_plans(0.3, kTicksToTheGait);
  ASSERT_EQ(rig->level(), FallbackLevel::gait);
  int followed = 0;
  const auto offer = [&](model::ContactMode mode) {
    rig->plan_once_more([&](control::Plan& plan) {
      plan.start_time_s = rig->cycle.time_s();
      for (control::PlanNode& node : plan.node) node.mode = mode;
    });
    rig->run(1);
    if (rig->level() == FallbackLevel::plan) ++followed;
  };
  offer({true, true});
  EXPECT_EQ(followed, 0);
  offer({true, false});
  if (followed == 0) offer({false, true});
  EXPECT_EQ(followed, 1);
}

TEST_F(GaitLevelTest, AStopWaitsForAPlanWithTheFootOfTheGaitOnTheGround) {
  step_towards_a_selected_gait();
  rig->run(1700);
  ASSERT_EQ(rig->level(), FallbackLevel::gait);
  const auto offer = [&](model::ContactMode mode) {
    rig->plan_once_more([&](control::Plan& plan) {
      const double shift_s = rig->cycle.time_s() - plan.start_time_s;
      plan.start_time_s += shift_s;
      for (control::PlanNode& node : plan.node) {
        node.time_s += shift_s;
        node.mode = mode;
      }
    });
    rig->run(1);
  };
  rig->ask(RequestKind::stand);
  for (int tick = 0; tick < 5000 && rig->state() != State::stand; ++tick) offer({true, true});
  ASSERT_EQ(rig->state(), State::stand);
  for (int tick = 0; tick < 20; ++tick) {
    offer({true, true});
    EXPECT_EQ(rig->level(), FallbackLevel::gait);
    EXPECT_TRUE(rig->decision().present.empty());
  }
  offer({true, false});
  if (rig->level() != FallbackLevel::plan) offer({false, true});
  EXPECT_EQ(rig->level(), FallbackLevel::plan);
  EXPECT_TRUE(rig->decision().latched.empty());
}

/// Stepping in place the phase of the gait is the time, so that it goes on though the joints stand still.
class GaitLevelSensorTest : public GaitLevelTest {
 protected:
  GaitLevelSensorTest()
      : unchanged_limit(static_cast<std::uint32_t>(rig->configuration.supervisor.unchanged_replies_limit)) {
    walk_on_without_plans(0.0, 0);
    for (int i = 0; i < kTicksToTheGait && rig->level() != FallbackLevel::gait; ++i) rig->run(1);
  }
  void freeze_encoders() {
    for (hal::JointReading& reading : rig->joints.readings) reading.unchanged_replies = unchanged_limit;
  }
  std::uint32_t unchanged_limit;
};

TEST_F(GaitLevelSensorTest, EncodersThatRepeatThemselvesWhileTheGaitMovesTheJointsAreStale) {
  ASSERT_EQ(rig->level(), FallbackLevel::gait);
  freeze_encoders();
  rig->run(kTicksToLeaveRest);
  EXPECT_TRUE(rig->decision().latched.has(supervisor::Fault::encoder_frozen));
  EXPECT_EQ(rig->level(), FallbackLevel::damp);
}

TEST_F(GaitLevelSensorTest, ATorsoSensorThatRepeatsItselfMeanwhileIsStale) {
  ASSERT_EQ(rig->level(), FallbackLevel::gait);
  rig->joints.base.unchanged_replies = unchanged_limit;
  rig->run(kTicksToLeaveRest);
  EXPECT_TRUE(rig->decision().latched.has(supervisor::Fault::stale_torso_sensor));
}

TEST_F(GaitLevelSensorTest, SensorsMayRepeatThemselvesWhenTheStepIsOverAndNoFootHasLanded) {
  rig->run(500);
  ASSERT_EQ(rig->level(), FallbackLevel::gait);
  freeze_encoders();
  rig->joints.base.unchanged_replies = unchanged_limit;
  rig->run(2);
  EXPECT_TRUE(rig->decision().latched.empty());
}

TEST_F(FallbackTest, SitWhenThePlannerStops) {
  rig->stand();
  rig->planning = false;
  rig->run(300);
  EXPECT_EQ(rig->state(), State::sit);
  EXPECT_EQ(rig->level(), FallbackLevel::sit);
  EXPECT_EQ(rig->mail.requests.newest().stance_episode, 0u) << "no plan is wanted any more";
  const double first_rad = rig->joints.commands[1].position_rad;
  rig->run(1000);
  EXPECT_GT(rig->joints.commands[1].position_rad, first_rad) << "the knees bend";
  rig->run(2000);
  EXPECT_EQ(rig->state(), State::fault) << "a latched cause: sitting ends in damping";
  EXPECT_EQ(rig->level(), FallbackLevel::damp);
}

TEST_F(FallbackTest, DampWhenRepliesAreLost) {
  rig->stand();
  rig->joints.silent = true;
  rig->run(11);
  EXPECT_EQ(rig->state(), State::fault);
  EXPECT_EQ(rig->level(), FallbackLevel::damp);
  for (const hal::JointCommand& command : rig->joints.commands) {
    EXPECT_EQ(command.kp_Nm_rad, 0);
    EXPECT_EQ(command.torque_Nm, 0);
    EXPECT_GT(command.kd_Nms_rad, 0);
  }
}

TEST_F(FallbackTest, DampingTorqueIsBoundedAtAnySpeed) {
  rig->stand();
  rig->joints.emergency_stop = hal::EmergencyStopState::pressed;
  for (const double speed_rad_s : {0.1, 5.0, 17.0}) {
    for (hal::JointReading& reading : rig->joints.readings) reading.velocity_rad_s = speed_rad_s;
    rig->run(1);
    for (const hal::JointCommand& command : rig->joints.commands) {
      EXPECT_LE(command.kd_Nms_rad * speed_rad_s,
                rig->configuration.supervisor.damping_torque_Nm * (1 + 1e-12));
    }
  }
}

TEST_F(FallbackTest, OffAtTheEndByWayOfSitting) {
  rig->stand();
  rig->command.shut_down = true;
  rig->run(1);
  EXPECT_EQ(rig->state(), State::sit);
  rig->run(static_cast<int>(1000 * rig->configuration.supervisor.sit_s) + 5);
  EXPECT_EQ(rig->state(), State::ready);
  EXPECT_EQ(rig->level(), FallbackLevel::damp);
  rig->run(rig->damped_ticks());
  EXPECT_EQ(rig->state(), State::off);
  EXPECT_EQ(rig->level(), FallbackLevel::off);
  EXPECT_GT(rig->joints.disables, 0);
  const int writes = rig->joints.writes;
  rig->run(50);
  EXPECT_EQ(rig->joints.writes, writes) << "nothing but disabling";
}

TEST_F(GaitLevelTest, NoLevelIsLeftOut) {
  walk_on_without_plans(0.3, kTicksToTheGait);
  rig->command.shut_down = true;
  for (int tick = 0; tick < 10000 && rig->state() != State::off; ++tick) rig->run(1);
  for (std::size_t number = 0; number < supervisor::kFallbackLevels; ++number) {
    const auto level = static_cast<FallbackLevel>(number);
    EXPECT_NE(std::ranges::find(rig->levels, level), rig->levels.end()) << supervisor::name(level);
  }
}

}  // namespace
}  // namespace stilt::control_loop
