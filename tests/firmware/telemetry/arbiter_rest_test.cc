// A cut is final, the way to rest needs no host, and a robot without a commander begins nothing.
#include <gtest/gtest.h>

#include <string>

#include "arbiter_fixture.h"

namespace stilt::telemetry {
namespace {

using supervisor::Fault;
using supervisor::RequestKind;
using supervisor::State;

TEST_F(CommandArbiterTest, a_cut_outlasts_whatever_follows_it) {
  now.state = State::walk;
  ASSERT_TRUE(take(CommandKind::walk, 0.3).accepted);
  ASSERT_TRUE(take(CommandKind::cut, 0, "bert").accepted);
  EXPECT_TRUE(take(CommandKind::stop).accepted);
  EXPECT_TRUE(take(CommandKind::release).accepted);
  for (const CommandKind kind : {CommandKind::walk, CommandKind::stand, CommandKind::sit, CommandKind::off}) {
    const Answer answer = take(kind, 0.3);
    EXPECT_FALSE(answer.accepted) << name(kind);
    EXPECT_EQ(answer.reason, "stiltd is ending, and takes no more orders");
  }
  pass(2.1);
  EXPECT_EQ(command().request.kind, RequestKind::cut);
}

TEST_F(CommandArbiterTest, a_cut_outlasts_the_silence_of_the_commander_in_the_same_step) {
  now.state = State::walk;
  ASSERT_TRUE(take(CommandKind::walk, 0.3).accepted);
  pass(2.1);
  ASSERT_TRUE(take(CommandKind::cut, 0, "bert").accepted);
  EXPECT_EQ(command().request.kind, RequestKind::cut);
}

TEST_F(CommandArbiterTest, a_program_that_ends_takes_stop_and_cut_alone) {
  now.state = State::walk;
  script.shut_down = true;
  static_cast<void>(command());
  EXPECT_FALSE(take(CommandKind::walk, 0.3).accepted);
  EXPECT_FALSE(take(CommandKind::step).accepted);
  EXPECT_TRUE(take(CommandKind::stop).accepted);
  EXPECT_TRUE(take(CommandKind::cut).accepted);
}

TEST_F(CommandArbiterTest, the_way_to_rest_goes_on_without_who_asked_for_it) {
  for (const CommandKind kind : {CommandKind::sit, CommandKind::off}) {
    for (const bool releases : {false, true}) {
      now.state = State::walk;
      ASSERT_TRUE(take(CommandKind::walk, 0.3).accepted);
      ASSERT_TRUE(take(kind).accepted);
      const auto asked = command().request;
      if (releases) {
        ASSERT_TRUE(take(CommandKind::release).accepted);
      }
      pass(2.1);
      EXPECT_EQ(command().request.kind, asked.kind) << name(kind) << releases;
      EXPECT_EQ(command().request.number, asked.number);
      EXPECT_EQ(arbiter.commander(), "");
    }
  }
}

TEST_F(CommandArbiterTest, a_release_on_the_way_up_leaves_nothing_to_walk_or_stand_up_for) {
  now.state = State::stand;  // along the ramp
  ASSERT_TRUE(take(CommandKind::walk, 0.3).accepted);
  ASSERT_TRUE(take(CommandKind::release).accepted);
  EXPECT_EQ(command().request.kind, RequestKind::stand);
  now.state = State::ready;
  ASSERT_TRUE(take(CommandKind::stand).accepted);
  ASSERT_TRUE(take(CommandKind::release).accepted);
  EXPECT_EQ(command().request.kind, RequestKind::none);
}

TEST_F(CommandArbiterTest, a_stand_that_waits_in_ready_ends_with_the_silence_of_the_commander) {
  now.state = State::ready;
  ASSERT_TRUE(take(CommandKind::stand).accepted);
  pass(0.39);
  EXPECT_EQ(command().request.kind, RequestKind::stand);
  pass(0.02);
  EXPECT_EQ(command().request.kind, RequestKind::none);
}

TEST_F(CommandArbiterTest, a_commander_that_was_lost_is_back_with_its_next_sign_of_life) {
  for (const CommandKind sign : {CommandKind::heartbeat, CommandKind::stop}) {
    now.state = State::walk;
    ASSERT_TRUE(take(CommandKind::walk, 0.3).accepted);
    pass(2.1);
    EXPECT_EQ(command().request.kind, RequestKind::stand);
    ASSERT_EQ(arbiter.commander(), "");
    static_cast<void>(take(CommandKind::heartbeat, 0, "bert"));
    EXPECT_EQ(arbiter.commander(), "") << "bert has never commanded";
    now.state = State::stand;
    pass(5);
    ASSERT_TRUE(take(sign).accepted);
    EXPECT_EQ(arbiter.commander(), "anna");
    EXPECT_EQ(command().request.kind, RequestKind::stand) << "it does not walk again by itself";
    EXPECT_EQ(command().heartbeat_ns, now.clock_ns);
  }
}

TEST_F(CommandArbiterTest, a_lost_commander_does_not_come_back_over_the_next_one) {
  ASSERT_TRUE(take(CommandKind::walk, 0.3).accepted);
  pass(2.1);
  static_cast<void>(command());
  ASSERT_TRUE(take(CommandKind::stand, 0, "bert").accepted);
  ASSERT_TRUE(take(CommandKind::release, 0, "bert").accepted);
  static_cast<void>(take(CommandKind::heartbeat));
  EXPECT_EQ(arbiter.commander(), "");
}

TEST_F(CommandArbiterTest, a_stop_says_what_it_drops) {
  const auto reason_after = [this](CommandKind kind, State asked_in, State stopped_in) {
    now.state = asked_in;
    EXPECT_TRUE(take(kind).accepted);
    static_cast<void>(command());
    now.state = stopped_in;
    return take(CommandKind::stop).reason;
  };
  const std::string stand = ", and the request to stand is dropped";
  EXPECT_EQ(reason_after(CommandKind::stand, State::ready, State::ready),
            "the robot is in state ready" + stand);
  EXPECT_EQ(reason_after(CommandKind::stand, State::idle, State::calibrate),
            "the robot is in state calibrate" + stand);
  EXPECT_EQ(reason_after(CommandKind::off, State::stand, State::sit),
            "the robot is in state sit, and the request to switch off is dropped");
  for (const State damped : {State::ready, State::fault}) {
    EXPECT_EQ(reason_after(CommandKind::off, State::stand, damped),
              std::string("the robot is in state ") + supervisor::name(damped) +
                  ", and the request to switch off is dropped");
  }
  EXPECT_EQ(reason_after(CommandKind::reset, State::fault, State::fault),
            "the robot is in state fault, and the request to reset is dropped");
  EXPECT_EQ(reason_after(CommandKind::sit, State::stand, State::sit),
            "the robot is in state sit, where stop changes nothing");
}

TEST_F(CommandArbiterTest, a_reset_and_an_off_that_wait_until_the_joints_were_damped_say_so) {
  now.state = State::fault;
  now.damping_left_s = 2.44;
  for (const CommandKind kind : {CommandKind::reset, CommandKind::off}) {
    const Answer answer = take(kind);
    EXPECT_TRUE(answer.accepted) << name(kind);
    EXPECT_EQ(answer.reason, "the joints are damped for 2.4 s first");
  }
  now.present.add(Fault::bus_off);
  EXPECT_EQ(take(CommandKind::reset).reason,
            "bus_off is still there: this reset ends after 2.9 s; reset again when that is over");
  now.damping_left_s = 0;
  EXPECT_EQ(take(CommandKind::off).reason, "");
}

TEST_F(CommandArbiterTest, orders_that_waited_while_stiltd_stood_still_are_refused_and_stops_are_not) {
  now.state = State::walk;
  ASSERT_TRUE(take(CommandKind::walk, 0.3).accepted);
  now.standstill_s = 0.39;
  EXPECT_TRUE(take(CommandKind::walk, 0.4).accepted);
  now.standstill_s = 9.96;
  for (const CommandKind kind :
       {CommandKind::walk, CommandKind::speed, CommandKind::sit, CommandKind::reset}) {
    const Answer answer = take(kind, 0.1);
    EXPECT_FALSE(answer.accepted) << name(kind);
    EXPECT_EQ(answer.reason, "stiltd stood still for 10 s while this order came: look, then order again");
  }
  EXPECT_TRUE(take(CommandKind::heartbeat).accepted);
  EXPECT_TRUE(take(CommandKind::stop).accepted);
  EXPECT_TRUE(take(CommandKind::cut).accepted);
}

TEST_F(CommandArbiterTest, steps_of_a_robot_that_a_fault_makes_sit_are_refused_with_the_fault) {
  now.latched.add(Fault::low_voltage);
  for (const State state : {State::stand, State::step, State::walk}) {
    now.state = state;
    for (const CommandKind kind : {CommandKind::step, CommandKind::walk}) {
      const Answer answer = take(kind, 0.1);
      EXPECT_FALSE(answer.accepted) << name(kind);
      EXPECT_EQ(answer.reason, "low_voltage: the robot is about to sit down; reset it then");
    }
  }
  EXPECT_TRUE(take(CommandKind::sit).accepted);
}

}  // namespace
}  // namespace stilt::telemetry
