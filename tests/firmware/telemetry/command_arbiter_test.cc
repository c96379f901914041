#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "arbiter_fixture.h"

namespace stilt::telemetry {
namespace {

using supervisor::RequestKind;
using supervisor::State;

/// What is wrong with a command, and a word of the answer.
struct Refusal {
  const char* what;
  void (*spoil)(Asked&);
  const char* says;
};

class Refused : public CommandArbiterTest, public testing::WithParamInterface<Refusal> {};

TEST_P(Refused, with_a_reason_and_without_effect) {
  Asked command = asked(CommandKind::walk, 0.3);
  ASSERT_TRUE(take(command).accepted);
  const std::uint32_t before = this->command().request.number;
  command = asked(CommandKind::walk, 0.4);
  GetParam().spoil(command);
  const Answer answer = take(command);
  EXPECT_FALSE(answer.accepted);
  EXPECT_NE(answer.reason.find(GetParam().says), std::string::npos) << answer.reason;
  EXPECT_EQ(this->command().request.number, before);
  EXPECT_EQ(this->command().request.speed_m_s, 0.3);
}

INSTANTIATE_TEST_SUITE_P(
    Commands, Refused,
    testing::Values(
        Refusal{"another_run", [](Asked& c) { c.run_id = 78; }, "another run"},
        Refusal{"no_token", [](Asked& c) { c.token.clear(); }, "first line of /run/token"},
        Refusal{"wrong_token", [](Asked& c) { c.token = "secreu"; }, "token is wrong"},
        Refusal{"half_a_token", [](Asked& c) { c.token = "secre"; }, "token is wrong"},
        Refusal{"no_name", [](Asked& c) { c.commander.clear(); }, "needs a name"},
        Refusal{"long_name", [](Asked& c) { c.commander.assign(65, 'a'); }, "needs a name"},
        Refusal{"unknown_kind", [](Asked& c) { c.kind = 14; }, "no kind of command 14"},
        Refusal{"same_number", [](Asked& c) { c.number = 1; }, "came after 1"},
        Refusal{"older_number", [](Asked& c) { c.number = 0; }, "came after 1"},
        Refusal{"too_fast", [](Asked& c) { c.value = 0.81; }, "beyond telemetry.speed_limit_m_s, 0.8"},
        Refusal{"too_fast_backwards", [](Asked& c) { c.value = -0.81; }, "0.8 m/s either way"},
        Refusal{"nan", [](Asked& c) { c.value = std::nan(""); }, "not a number"},
        Refusal{"infinite", [](Asked& c) { c.value = std::numeric_limits<double>::infinity(); },
                "not a number"},
        Refusal{"another_commander", [](Asked& c) { c.commander = "bert"; }, "anna commands the robot"}),
    [](const auto& refusal) { return refusal.param.what; });

TEST(CommandKind, a_number_that_is_no_kind_has_a_name) {
  for (std::size_t number = kCommandKinds; number < 256; ++number) {
    EXPECT_STREQ(name(static_cast<CommandKind>(number)), "unknown");
  }
  EXPECT_STREQ(name(CommandKind::cut), "cut");
}

TEST_F(CommandArbiterTest,
       commands_without_the_token_are_answered_twenty_times_per_second_however_many_come) {
  int answers = 0;
  for (int k = 0; k < 10'000; ++k) {
    Asked guess = asked(CommandKind::walk, 0.3, "bert");
    guess.token = "guess";
    const Answer answer = take(guess);
    ASSERT_FALSE(answer.accepted);
    answers += answer.silent ? 0 : 1;
    pass(1e-4);
  }
  EXPECT_EQ(answers, 20);
  EXPECT_FALSE(take(CommandKind::walk, 0.3).silent) << "those with the token are always answered";
}

/// Which kinds are accepted in which state.
TEST_F(CommandArbiterTest, takes_only_what_makes_sense_in_the_state) {
  const std::vector<std::pair<CommandKind, std::vector<State>>> table = {
      {CommandKind::prepare, {State::idle}},
      {CommandKind::stand,
       {State::idle, State::calibrate, State::ready, State::stand, State::step, State::walk}},
      {CommandKind::step, {State::stand, State::step, State::walk}},
      {CommandKind::walk, {State::stand, State::step, State::walk}},
      {CommandKind::speed, {State::walk}},
      {CommandKind::sit, {State::stand, State::step, State::walk}},
      {CommandKind::reset, {State::fault}},
      {CommandKind::height,
       {State::boot, State::idle, State::calibrate, State::ready, State::stand, State::step, State::walk,
        State::sit, State::fault}},
  };
  for (const auto& [kind, states] : table) {
    for (std::size_t s = 0; s < supervisor::kStates; ++s) {
      now.state = static_cast<State>(s);
      const bool expected = std::ranges::find(states, now.state) != states.end();
      EXPECT_EQ(take(kind).accepted, expected) << name(kind) << " in " << supervisor::name(now.state);
    }
  }
}

TEST_F(CommandArbiterTest, a_reset_whose_cause_is_still_there_and_a_stop_that_changes_nothing_say_so) {
  now.state = State::fault;
  now.present.add(supervisor::Fault::bus_off);
  const Answer early = take(CommandKind::reset);
  EXPECT_TRUE(early.accepted) << "it makes lost connections again";
  EXPECT_EQ(early.reason,
            "bus_off is still there: this reset ends after 0.5 s; reset again when that is over");
  now.present = {};
  now.present.add(supervisor::Fault::driver_not_enabled);
  EXPECT_EQ(take(CommandKind::reset).reason, "") << "no reset waits for it";
  now.state = State::idle;
  const Answer idle = take(CommandKind::stop);
  EXPECT_TRUE(idle.accepted);
  EXPECT_EQ(idle.reason, "the robot is in state idle, where stop changes nothing");
  now.state = State::walk;
  EXPECT_EQ(take(CommandKind::stop).reason, "");
}

TEST_F(CommandArbiterTest, without_commands_the_script_continues_and_no_heartbeat_is_needed) {
  script.request = {RequestKind::walk, 4, 0.5};
  EXPECT_TRUE(take(CommandKind::heartbeat).silent);
  const auto sent = command();
  EXPECT_EQ(sent.request.kind, RequestKind::walk);
  EXPECT_EQ(sent.request.number, 4u);
  EXPECT_FALSE(sent.heartbeat_expected);
}

TEST_F(CommandArbiterTest, an_order_takes_over_from_the_script_with_a_higher_number) {
  script.request = {RequestKind::walk, 4, 0.5};
  static_cast<void>(command());
  ASSERT_TRUE(take(CommandKind::step).accepted);
  const auto sent = command();
  EXPECT_EQ(sent.request.kind, RequestKind::step);
  EXPECT_EQ(sent.request.number, 5u);
  EXPECT_TRUE(sent.heartbeat_expected);
  EXPECT_EQ(arbiter.commander(), "anna");
}

TEST_F(CommandArbiterTest, the_end_of_the_program_stays_the_scripts) {
  ASSERT_TRUE(take(CommandKind::step).accepted);
  script.shut_down = true;
  EXPECT_TRUE(command().shut_down);
}

TEST_F(CommandArbiterTest, gives_the_torque_loop_in_its_clock_the_last_sign_of_life_of_the_commander) {
  ASSERT_TRUE(take(CommandKind::walk, 0.3).accepted);
  pass(0.25);
  EXPECT_EQ(command().heartbeat_ns, now.clock_ns - kSecond_ns / 4);
  EXPECT_TRUE(take(CommandKind::heartbeat).accepted);
  EXPECT_EQ(command().heartbeat_ns, now.clock_ns);
}

TEST_F(CommandArbiterTest, a_virtual_clock_does_not_age_heartbeats) {
  ASSERT_TRUE(take(CommandKind::walk, 0.3).accepted);
  now.clock_ns += 10 * kSecond_ns;
  EXPECT_EQ(command().heartbeat_ns, now.clock_ns);
}

TEST_F(CommandArbiterTest, heartbeats_of_others_do_not_keep_a_commander_alive) {
  ASSERT_TRUE(take(CommandKind::walk, 0.3).accepted);
  pass(0.5);
  static_cast<void>(take(CommandKind::heartbeat, 0, "bert"));
  EXPECT_FALSE(arbiter.alive(now));
}

TEST_F(CommandArbiterTest, a_silent_commander_is_replaced_and_a_living_one_is_not) {
  ASSERT_TRUE(take(CommandKind::walk, 0.3).accepted);
  pass(0.3);
  EXPECT_FALSE(take(CommandKind::step, 0, "bert").accepted);
  pass(0.2);
  EXPECT_TRUE(take(CommandKind::step, 0, "bert").accepted);
  EXPECT_EQ(arbiter.commander(), "bert");
}

TEST_F(CommandArbiterTest, a_silent_commander_leaves_a_robot_that_stands_and_whose_silence_goes_on) {
  now.state = State::walk;
  ASSERT_TRUE(take(CommandKind::walk, 0.3).accepted);
  const auto number_before = command().request.number;
  pass(1.9);
  EXPECT_TRUE(command().heartbeat_expected);
  pass(0.2);
  const auto sent = command();
  EXPECT_TRUE(sent.heartbeat_expected) << "the operator may be absent";
  EXPECT_EQ(sent.request.kind, RequestKind::stand);
  EXPECT_GT(sent.request.number, number_before);
  EXPECT_EQ(arbiter.commander(), "");
  pass(30);
  EXPECT_EQ(command().heartbeat_ns, now.clock_ns - 321 * kSecond_ns / 10);
  ASSERT_TRUE(take(CommandKind::stand, 0, "bert").accepted);
  ASSERT_TRUE(take(CommandKind::release, 0, "bert").accepted);
  EXPECT_FALSE(command().heartbeat_expected) << "who gives up the command was there";
}

TEST_F(CommandArbiterTest, everybody_with_the_token_may_cut) {
  now.state = State::walk;
  ASSERT_TRUE(take(CommandKind::walk, 0.3).accepted);
  EXPECT_TRUE(take(CommandKind::cut, 0, "bert").accepted);
  EXPECT_EQ(command().request.kind, RequestKind::cut);
}

TEST_F(CommandArbiterTest, everybody_with_the_token_may_stop) {
  now.state = State::walk;
  ASSERT_TRUE(take(CommandKind::walk, 0.3).accepted);
  ASSERT_TRUE(take(CommandKind::stop, 0, "bert").accepted);
  EXPECT_EQ(command().request.kind, RequestKind::stand);
  Asked forged = asked(CommandKind::stop, 0, "carl");
  forged.token = "x";
  EXPECT_FALSE(take(forged).accepted);
}

TEST_F(CommandArbiterTest, stop_of_a_robot_that_is_not_on_its_feet_asks_for_nothing) {
  now.state = State::idle;
  ASSERT_TRUE(take(CommandKind::stand).accepted);
  ASSERT_TRUE(take(CommandKind::stop).accepted);
  now.state = State::ready;
  EXPECT_EQ(command().request.kind, RequestKind::none);
}

TEST_F(CommandArbiterTest, stand_from_idle_brings_the_drivers_up_first) {
  now.state = State::idle;
  ASSERT_TRUE(take(CommandKind::stand).accepted);
  EXPECT_EQ(command().request.kind, RequestKind::calibrate);
  now.state = State::calibrate;
  EXPECT_EQ(command().request.kind, RequestKind::calibrate);
  now.state = State::ready;
  EXPECT_EQ(command().request.kind, RequestKind::stand);
}

TEST_F(CommandArbiterTest, standing_up_ends_when_the_commander_falls_silent_on_the_way) {
  now.state = State::idle;
  ASSERT_TRUE(take(CommandKind::stand).accepted);
  pass(0.5);
  now.state = State::ready;
  EXPECT_EQ(command().request.kind, RequestKind::none);
}

TEST_F(CommandArbiterTest, speed_changes_the_walk_that_is_on) {
  now.state = State::walk;
  ASSERT_TRUE(take(CommandKind::walk, 0.3).accepted);
  const auto number_before = command().request.number;
  ASSERT_TRUE(take(CommandKind::speed, -0.2).accepted);
  EXPECT_EQ(command().request.speed_m_s, -0.2);
  EXPECT_EQ(command().request.number, number_before);
  EXPECT_FALSE(take(CommandKind::speed, 0.81).accepted) << "0.8 m/s is the limit";
  EXPECT_EQ(command().request.speed_m_s, -0.2);
}

TEST_F(CommandArbiterTest, release_of_a_walking_or_stepping_robot_lets_it_stand) {
  for (const auto& [state, order] :
       {std::pair(State::walk, CommandKind::walk), {State::step, CommandKind::step}}) {
    now.state = state;
    ASSERT_TRUE(take(order, 0.3).accepted);
    EXPECT_FALSE(take(CommandKind::release, 0, "bert").accepted);
    ASSERT_TRUE(take(CommandKind::release).accepted);
    EXPECT_EQ(command().request.kind, RequestKind::stand) << supervisor::name(state);
    EXPECT_FALSE(command().heartbeat_expected);
    EXPECT_EQ(arbiter.commander(), "");
  }
}

TEST_F(CommandArbiterTest, release_of_a_robot_at_rest_asks_for_nothing_new) {
  now.state = State::stand;
  ASSERT_TRUE(take(CommandKind::stand).accepted);
  const std::uint32_t before = command().request.number;
  ASSERT_TRUE(take(CommandKind::release).accepted);
  EXPECT_EQ(command().request.number, before);
}

TEST_F(CommandArbiterTest, release_on_the_way_up_from_idle_ends_the_way_up) {
  now.state = State::idle;
  ASSERT_TRUE(take(CommandKind::stand).accepted);
  now.state = State::calibrate;
  ASSERT_TRUE(take(CommandKind::release).accepted);
  now.state = State::ready;
  EXPECT_EQ(command().request.kind, RequestKind::none);
}

TEST_F(CommandArbiterTest, another_order_on_the_way_up_from_idle_ends_the_way_up) {
  now.state = State::idle;
  ASSERT_TRUE(take(CommandKind::stand).accepted);
  ASSERT_TRUE(take(CommandKind::off).accepted);
  now.state = State::ready;
  EXPECT_EQ(command().request.kind, RequestKind::off);
}

TEST_F(CommandArbiterTest, an_order_makes_who_gives_it_alive) {
  ASSERT_TRUE(take(CommandKind::stand).accepted);
  pass(0.39);
  ASSERT_TRUE(take(CommandKind::stand).accepted);
  pass(0.39);
  EXPECT_TRUE(arbiter.alive(now));
  pass(0.02);
  EXPECT_FALSE(arbiter.alive(now));
}

TEST_F(CommandArbiterTest, a_commander_that_stays_alive_is_never_relieved) {
  now.state = State::walk;
  ASSERT_TRUE(take(CommandKind::walk, 0.3).accepted);
  for (int beat = 0; beat < 30; ++beat) {
    pass(0.3);
    ASSERT_TRUE(take(CommandKind::heartbeat).accepted);
    ASSERT_EQ(command().request.kind, RequestKind::walk);
  }
  EXPECT_EQ(arbiter.commander(), "anna");
}

TEST_F(CommandArbiterTest, numbers_of_different_commanders_do_not_mix) {
  ASSERT_TRUE(take(asked(CommandKind::heartbeat, 0, "anna")).accepted);
  Asked other = asked(CommandKind::heartbeat, 0, "bert");
  other.number = 1;
  EXPECT_TRUE(take(other).accepted);
}

TEST_F(CommandArbiterTest, the_257th_commander_of_a_run_is_refused_and_the_first_is_not) {
  for (int i = 0; i < 256; ++i) {
    ASSERT_TRUE(take(CommandKind::heartbeat, 0, "commander " + std::to_string(i)).accepted) << i;
  }
  const Answer answer = take(CommandKind::heartbeat, 0, "one more");
  EXPECT_FALSE(answer.accepted);
  EXPECT_NE(answer.reason.find("too many commanders"), std::string::npos);
  EXPECT_TRUE(take(CommandKind::heartbeat, 0, "commander 0").accepted);
}

TEST_F(CommandArbiterTest, of_those_beyond_the_most_commanders_only_the_newest_few_are_remembered) {
  now.state = State::walk;
  for (int i = 0; i < 256; ++i) ASSERT_TRUE(take(CommandKind::heartbeat, 0, std::to_string(i)).accepted);
  std::vector<Asked> stops;
  for (int i = 0; i < 65; ++i) stops.push_back(asked(CommandKind::stop, 0, "late " + std::to_string(i)));
  for (const Asked& stop : stops) ASSERT_TRUE(take(stop).accepted);
  for (int i = 1; i < 65; ++i) ASSERT_FALSE(take(stops[static_cast<std::size_t>(i)]).accepted) << i;
  EXPECT_TRUE(take(stops[0]).accepted) << "forgotten, so that memory has an end";
}

TEST_F(CommandArbiterTest, of_more_commanders_than_there_may_be_each_may_stop_and_cut_once) {
  now.state = State::walk;
  for (int i = 0; i < 256; ++i) ASSERT_TRUE(take(CommandKind::heartbeat, 0, std::to_string(i)).accepted);
  ASSERT_FALSE(take(CommandKind::walk, 0.1, "the last").accepted);
  for (const CommandKind kind : {CommandKind::stop, CommandKind::cut}) {
    const Asked order = asked(kind, 0, std::string("the last to ") + name(kind));
    EXPECT_TRUE(take(order).accepted) << name(kind);
    EXPECT_NE(take(order).reason.find("sent twice"), std::string::npos) << "without the token";
  }
  EXPECT_EQ(command().request.kind, RequestKind::cut);
}

TEST_F(CommandArbiterTest, a_robot_whose_torque_does_not_suffice_refuses_to_step_and_names_what_would_do) {
  ArbiterRules weak = rules();
  weak.supervisor.torque_limit_share = 0.3;
  weak.supervisor.walk_torque_share = 0.6;
  arbiter = CommandArbiter(weak, {});
  for (const CommandKind kind : {CommandKind::step, CommandKind::walk}) {
    const Answer answer = take(kind, 0.1);
    EXPECT_FALSE(answer.accepted) << name(kind);
    EXPECT_EQ(answer.reason, std::string(name(kind)) +
                                 " needs supervisor.torque_limit_share of at least 0.6 "
                                 "(supervisor.walk_torque_share), and it is 0.3");
  }
  EXPECT_EQ(arbiter.commander(), "");
  EXPECT_TRUE(take(CommandKind::stand).accepted);
  weak.supervisor.torque_limit_share = 1.0;
  weak.supervisor.plan_torque_share = 0.5;
  arbiter = CommandArbiter(weak, {});
  EXPECT_EQ(
      take(CommandKind::walk, 0.1).reason,
      "walk needs robot.torque_limit_scale of at least 0.6 (supervisor.walk_torque_share), and it is 0.5");
  weak.supervisor.torque_limit_share = 0.6;
  weak.supervisor.plan_torque_share = 0.6;
  arbiter = CommandArbiter(weak, {});
  EXPECT_TRUE(take(CommandKind::walk, 0.1).accepted);
}

TEST_F(CommandArbiterTest, without_a_token_of_its_own_the_arbiter_accepts_nothing) {
  ArbiterRules open = rules();
  open.token.clear();
  CommandArbiter other(open, {});
  Asked command = asked(CommandKind::step);
  command.token.clear();
  EXPECT_FALSE(other.take(command, now).accepted);
}

}  // namespace
}  // namespace stilt::telemetry
