#include <gtest/gtest.h>

#include <string>

#include "arbiter_fixture.h"
#include "firmware/telemetry/secret.h"

namespace stilt::telemetry {
namespace {

using supervisor::State;

/// What a program of the domain without the token can make of the commands that it reads.
TEST_F(CommandArbiterTest, a_proof_is_as_good_as_the_token_for_its_own_command_once) {
  now.state = State::walk;
  const auto prove = [](Asked& command) {
    command.token = proof("secret", {command.run_id, command.commander, command.number, command.kind,
                                     command.value, command.key});
  };
  Asked command = asked(CommandKind::walk, 0.3);
  prove(command);
  EXPECT_TRUE(take(command).accepted);
  const Answer again = take(command);
  EXPECT_FALSE(again.accepted) << "a repetition";
  EXPECT_NE(again.reason.find("is late, or was sent twice"), std::string::npos) << again.reason;
  EXPECT_TRUE(take(command).silent) << "a flood of repetitions is not answered with another";
  ++command.number;
  EXPECT_FALSE(take(command).accepted) << "the next number with an old proof";
  command.commander = "bert";
  EXPECT_FALSE(take(command).accepted) << "in another name";
  prove(command);
  command.value = 0.8;
  EXPECT_FALSE(take(command).accepted) << "with another speed";
  command.value = 0.3;
  command.kind = static_cast<std::uint8_t>(CommandKind::stop);
  EXPECT_FALSE(take(command).accepted) << "as another command";
  prove(command);
  EXPECT_TRUE(take(command).accepted);
}

/// Megabytes in a command would cost the thread of the heartbeats their time.
TEST_F(CommandArbiterTest, proves_nothing_by_a_text_that_no_commander_sends) {
  Asked command = asked(CommandKind::tunable, 1.0);
  command.key = std::string(65, 'k');
  command.token = proof("secret", {command.run_id, command.commander, command.number, command.kind,
                                   command.value, command.key});
  EXPECT_NE(take(command).reason.find("token is wrong"), std::string::npos);
}

}  // namespace
}  // namespace stilt::telemetry
