#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "arbiter_fixture.h"

/// Values beside the orders: tunables, and the speed of a Twist.
namespace stilt::telemetry {
namespace {

using supervisor::RequestKind;
using supervisor::State;

TEST_F(CommandArbiterTest, tunables_pass_on_and_their_refusals_come_back) {
  Asked command = asked(CommandKind::tunable, 55);
  command.key = "torque_law.joint_kp_Nm_rad";
  EXPECT_TRUE(take(command).accepted);
  tunable_answer = "out of range";
  const Answer answer = take(CommandKind::height, 2.5);
  EXPECT_FALSE(answer.accepted);
  EXPECT_EQ(answer.reason, "out of range");
  ASSERT_EQ(tunables.size(), 2u);
  EXPECT_EQ(tunables[0], std::pair(std::string("torque_law.joint_kp_Nm_rad"), 55.0));
  EXPECT_EQ(tunables[1], std::pair(std::string("reference.base_height_m"), 2.5));
}

TEST_F(CommandArbiterTest, who_only_tunes_does_not_command) {
  script.request = {RequestKind::walk, 4, 0.5};
  ASSERT_TRUE(take(CommandKind::height, 0.8).accepted);
  EXPECT_EQ(arbiter.commander(), "");
  EXPECT_EQ(command().request.number, 4u);
}

TEST_F(CommandArbiterTest, a_twist_acts_while_a_commander_lives_and_the_robot_walks) {
  now.state = State::walk;
  arbiter.twist(0.1, now);
  EXPECT_EQ(command().request.speed_m_s, 0.0);
  ASSERT_TRUE(take(CommandKind::walk, 0.3).accepted);
  arbiter.twist(0.1, now);
  EXPECT_EQ(command().request.speed_m_s, 0.1);
  arbiter.twist(5.0, now);
  arbiter.twist(std::nan(""), now);
  EXPECT_EQ(command().request.speed_m_s, 0.1);
  pass(0.5);
  arbiter.twist(0.2, now);
  EXPECT_EQ(command().request.speed_m_s, 0.3) << "the commander is silent, and the Twist before is over";
}

TEST_F(CommandArbiterTest, a_twist_counts_for_the_time_of_a_heartbeat_and_then_the_order_does) {
  now.state = State::walk;
  ASSERT_TRUE(take(CommandKind::walk, 0.3).accepted);
  const supervisor::Request ordered = command().request;
  for (const double speed_m_s : {0.8, -0.2, 0.0}) {
    arbiter.twist(speed_m_s, now);
    for (int i = 0; i < 3; ++i) {
      pass(0.1);
      ASSERT_TRUE(take(CommandKind::heartbeat).accepted);
      EXPECT_EQ(command().request.speed_m_s, speed_m_s) << i;
    }
    pass(0.2);
    ASSERT_TRUE(take(CommandKind::heartbeat).accepted);
    EXPECT_EQ(command().request.speed_m_s, 0.3) << "0.5 s after the last Twist";
  }
  EXPECT_EQ(command().request.kind, RequestKind::walk);
  EXPECT_EQ(command().request.number, ordered.number) << "nothing new is asked for";
}

TEST_F(CommandArbiterTest, a_later_order_ends_a_twist) {
  now.state = State::walk;
  ASSERT_TRUE(take(CommandKind::walk, 0.3).accepted);
  arbiter.twist(0.1, now);
  ASSERT_TRUE(take(CommandKind::speed, 0.4).accepted);
  EXPECT_EQ(command().request.speed_m_s, 0.4);
  arbiter.twist(0.1, now);
  EXPECT_EQ(command().request.speed_m_s, 0.1);
  ASSERT_TRUE(take(CommandKind::walk, 0.5).accepted);
  EXPECT_EQ(command().request.speed_m_s, 0.5);
}

TEST_F(CommandArbiterTest, a_twist_does_nothing_where_the_configuration_does_not_allow_it) {
  ArbiterRules strict = rules();
  strict.cmd_vel = false;
  CommandArbiter other(strict, {});
  now.state = State::walk;
  ASSERT_TRUE(other.take(asked(CommandKind::walk, 0.3), now).accepted);
  other.twist(0.1, now);
  EXPECT_EQ(other.command(script, now).request.speed_m_s, 0.3);
}

}  // namespace
}  // namespace stilt::telemetry
