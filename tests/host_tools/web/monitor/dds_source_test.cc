#include "host_tools/web/monitor/dds_source.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include "firmware/telemetry/reader.h"
#include "firmware/telemetry/secret.h"
#include "firmware/telemetry/tick_batch.h"
#include "firmware/telemetry/wire_version.h"
#include "firmware/telemetry/writer.h"
#include "tests/own_domain.h"
#include "tests/own_folder.h"

namespace stilt::monitor {
namespace {

/// Ignores what it is given, but replies.
class Ignored final : public SampleSink {
 public:
  void configuration(const ConfigurationSample&) override {}
  void tick(const TickSample&) override {}
  void plan(const PlanSample&) override {}
  void planner(const PlannerSample&) override {}
  void supervisor(const SupervisorSample&) override {}
  void event(const EventSample&) override {}
  void timing(const TimingSample&) override {}
  void truth(const TruthSample&) override {}
  void reply(const ReplySample& sample) override { replies.push_back(sample); }

  std::vector<ReplySample> replies;
};

/// Waits for something that comes, with a limit far beyond what it takes.
bool eventually(const std::function<bool()>& happened) {
  using namespace std::chrono_literals;
  const auto end = std::chrono::steady_clock::now() + 60s;
  while (std::chrono::steady_clock::now() < end) {
    if (happened()) return true;
    std::this_thread::sleep_for(5ms);
  }
  return false;
}

Command command(CommandKind kind, std::uint64_t commander = 0, std::uint32_t sequence = 0) {
  Command command;
  command.kind = kind;
  command.commander = commander;
  command.sequence = sequence;
  return command;
}

/// Runs that got a command, each with a token that it proved.
using Taken = std::set<std::pair<std::uint64_t, std::string>>;

/// The robots' ends of the topics that a monitor needs, for any number of runs.
class Robots {
 public:
  Robots()
      : participant_(*telemetry::Participant::open({.domain = tests::own_domain()})),
        configurations_(*telemetry::AnyWriter::open(participant_, telemetry::kConfiguration)),
        ticks_(*telemetry::AnyWriter::open(participant_, telemetry::kTicks)),
        replies_(*telemetry::AnyWriter::open(participant_, telemetry::kCommandReplies)),
        commands_(*telemetry::Reader::open(participant_, telemetry::kCommands)) {}

  void begin(std::uint64_t run_id, std::string token_file) {
    char empty[] = "", robot[] = "amber3m";
    telemetry::ActiveConfiguration message{};
    message.run_id = run_id;
    message.wire_version = telemetry::kWireVersion;
    message.robot = robot;
    message.configuration = message.version = message.compiler = message.instruction_set = message.realtime =
        message.urdf = empty;
    message.token_file = token_file.data();
    configurations_.write(&message);
  }

  void tick(std::uint64_t run_id) {
    telemetry::TickBatchBuilder builder;
    builder.add({});
    builder.message().run_id = run_id;
    ticks_.write(&builder.message());
  }

  /// What names a command.
  struct Received {
    std::string commander;
    std::uint64_t number = 0;
  };

  /// Both answer the commands that have come since the last call: the second refuses each before the first
  /// accepts it.
  void answer() {
    commands_.take([&](telemetry::Sample&& sample) {
      const auto command = sample.as<telemetry::Command>();
      if (!command) return;
      const std::string reason = "an answer";
      for (const std::uint64_t run_id : {2, 1}) {
        reply(run_id, {command->commander, command->number}, run_id == 1, reason, token_of(run_id));
      }
    });
  }

  /// The first command of a kind that has come since the last call.
  std::optional<Received> first(telemetry::CommandKind kind) {
    std::optional<Received> found;
    commands_.take([&](telemetry::Sample&& sample) {
      const auto command = sample.as<telemetry::Command>();
      if (!command || found || command->kind != static_cast<std::uint8_t>(kind)) return;
      found = Received{command->commander, command->number};
    });
    return found;
  }

  void accept(std::uint64_t run_id, const Received& command) {
    reply(run_id, command, true, "", token_of(run_id));
  }

  /// Anybody's reply, with the proof of a token.
  void reply(std::uint64_t run_id, Received command, bool accepted, std::string reason,
             const std::string& token) {
    std::string proof = telemetry::proof(
        token, telemetry::ReplyText{run_id, command.commander, command.number, accepted, reason, 0.0});
    const telemetry::CommandReply reply = {
        run_id, command.commander.data(), command.number, accepted, reason.data(), 0.0, proof.data()};
    replies_.write(&reply);
  }

  /// Runs of the commands of a kind that have come since the last call, each with the token that it proves.
  Taken taken(telemetry::CommandKind kind) {
    Taken all;
    commands_.take([&](telemetry::Sample&& sample) {
      const auto command = sample.as<telemetry::Command>();
      if (!command || command->kind != static_cast<std::uint8_t>(kind)) return;
      std::string proven = "no token";
      for (const std::string token : {"token_of_the_first", "token_of_the_second", "given by a page"}) {
        EXPECT_STRNE(command->token, token.c_str()) << "every program of the domain may read commands";
        const std::string proof =
            telemetry::proof(token, {command->run_id, command->commander, command->number, command->kind,
                                     command->value, command->key});
        if (proof == command->token) proven = token;
      }
      all.emplace(command->run_id, proven);
    });
    return all;
  }

 private:
  static std::string token_of(std::uint64_t run_id) {
    return run_id == 1 ? "token_of_the_first" : "token_of_the_second";
  }

  telemetry::Participant participant_;
  telemetry::AnyWriter configurations_, ticks_, replies_;
  telemetry::Reader commands_;
};

class TwoRobots : public testing::Test {
 protected:
  TwoRobots() {
    std::ofstream(folder_.file("first")) << "token_of_the_first\n";
    std::ofstream(folder_.file("second")) << "token_of_the_second\n";
    for (const char* name : {"first", "second"}) chmod(folder_.file(name).c_str(), S_IRUSR | S_IWUSR);
    robots_.begin(1, folder_.file("first"));
    meet([this] { return source_.has_token(); });
    robots_.begin(2, folder_.file("second"));
    meet([this] { return source_.talking().size() == 2; });
  }

  void meet(const std::function<bool()>& met) {
    ASSERT_TRUE(eventually([&] {
      robots_.tick(1);
      source_.poll(ignored_);
      return met();
    }));
  }

  /// Sends a command until the robots have it.
  Robots::Received sent(const Command& command) {
    std::optional<Robots::Received> received;
    EXPECT_TRUE(eventually([&] {
      source_.command(command);
      received = robots_.first(command.kind);
      return received.has_value();
    }));
    return received.value_or(Robots::Received{});
  }

  /// What comes to the robots of commands of a kind, at least so many.
  Taken got(CommandKind kind, std::size_t count) {
    Taken all;
    EXPECT_TRUE(eventually([&] {
      all.merge(robots_.taken(kind));
      return all.size() >= count;
    }));
    return all;
  }

  tests::OwnFolder folder_;
  Robots robots_;
  std::vector<std::string> warnings_;
  DdsSource source_{
      {.domain = tests::own_domain()}, "", [this](const std::string& text) { warnings_.push_back(text); }};
  Ignored ignored_;
};

TEST_F(TwoRobots, GetAStopEachWithItsOwnTokenAndOtherCommandsGoToTheOneThatIsShown) {
  Taken walks;
  ASSERT_TRUE(eventually([&] {
    source_.command(command(CommandKind::walk));
    walks.merge(robots_.taken(telemetry::CommandKind::walk));
    return !walks.empty();
  }));
  EXPECT_EQ(walks, (Taken{{1, "token_of_the_first"}}));
  Command stop = command(CommandKind::stop);
  stop.with_known_tokens = true;
  source_.command(stop);
  EXPECT_EQ(got(CommandKind::stop, 2), (Taken{{1, "token_of_the_first"}, {2, "token_of_the_second"}}));
}

/// A page without the monitor's key: what it stops is what it has tokens for.
TEST_F(TwoRobots, GetAStopWithTheTokensOfThePageAndNotWithThoseOfTheMonitor) {
  Command stop = command(CommandKind::stop);
  stop.token = "given by a page";
  const auto stops_after = [&](const Command& first, std::size_t count) {
    Taken stops;
    EXPECT_TRUE(eventually([&] {
      source_.command(first);
      stops.merge(robots_.taken(telemetry::CommandKind::stop));
      return stops.size() >= count;
    }));
    return stops;
  };
  EXPECT_EQ(stops_after(stop, 1), (Taken{{1, "given by a page"}}));
  stop.tokens_of_others["0000000000000002"] = "token_of_the_second";
  EXPECT_EQ(stops_after(stop, 2), (Taken{{1, "given by a page"}, {2, "token_of_the_second"}}));
}

/// A text in a field of the page must not keep the order from the robots.
TEST_F(TwoRobots, GetAStopAndACutWithTheTokensOfTheMonitorBesideAWrongOneOfAPage) {
  sent(command(CommandKind::sit));
  std::filesystem::remove(folder_.file("first"));  // it was read before
  Command order = command(CommandKind::stop);
  order.token = "given by a page";
  order.tokens_of_others["0000000000000002"] = "given by a page";
  order.with_known_tokens = true;
  source_.command(order);
  const Taken of_the_shown = {{1, "token_of_the_first"}, {1, "given by a page"}};
  Taken stops = of_the_shown;
  stops.insert({{2, "token_of_the_second"}, {2, "given by a page"}});
  EXPECT_EQ(got(CommandKind::stop, 4), stops);
  order.kind = CommandKind::cut;
  source_.command(order);
  EXPECT_EQ(got(CommandKind::cut, 2), of_the_shown);
  order.kind = CommandKind::walk;
  source_.command(order);
  EXPECT_EQ(got(CommandKind::walk, 1), (Taken{{1, "given by a page"}})) << "another order";
}

TEST_F(TwoRobots, AnswerAStopWithSeveralTokensOnce) {
  Command sit = command(CommandKind::sit, 5, 8);
  const Robots::Received last = sent(sit);
  Command stop = command(CommandKind::stop, 5, 9);
  stop.token = "given by a page";
  stop.with_known_tokens = true;
  const Robots::Received first = sent(stop);
  robots_.accept(1, first);
  robots_.reply(1, {first.commander, first.number + 1}, false, "a wrong token", "token_of_the_first");
  robots_.accept(1, last);
  ASSERT_TRUE(eventually([&] {
    source_.poll(ignored_);
    return ignored_.replies.size() >= 2;
  }));
  EXPECT_TRUE(ignored_.replies[0].accepted);
  EXPECT_EQ(ignored_.replies[0].sequence, 9u);
  EXPECT_EQ(ignored_.replies[1].sequence, 8u) << "no refusal of the wrong token";
}

/// Each receives every command, and the one that it is not for may be faster with its refusal.
TEST_F(TwoRobots, DoNotAnswerForEachOther) {
  ASSERT_TRUE(eventually([&] {
    source_.command(command(CommandKind::walk));
    robots_.answer();
    source_.poll(ignored_);
    return !ignored_.replies.empty();
  }));
  EXPECT_TRUE(ignored_.replies.front().accepted);
}

/// Every program of the domain reads commands and may answer them.
TEST_F(TwoRobots, AreAcceptedWhenTheyProveTheTokenOfTheCommand) {
  Command sit = command(CommandKind::sit, 5);
  const Robots::Received received = sent(sit);
  for (const char* token : {"", "a guess", "token_of_the_second"}) {
    robots_.reply(1, received, true, "", token);
  }
  robots_.reply(1, received, false, "a forged refusal", "a guess");
  robots_.reply(1, received, false, "and another", "a guess");
  robots_.accept(1, received);
  robots_.reply(1, received, false, "too late", "token_of_the_first");
  ASSERT_TRUE(eventually([&] {
    source_.poll(ignored_);
    return ignored_.replies.size() >= 2;
  }));
  ASSERT_EQ(ignored_.replies.size(), 2u);
  EXPECT_FALSE(ignored_.replies[0].accepted);
  EXPECT_FALSE(ignored_.replies[0].proven);
  EXPECT_EQ(ignored_.replies[0].reason, "a forged refusal");
  EXPECT_TRUE(ignored_.replies[1].accepted) << "the robot's own reply";
  EXPECT_TRUE(ignored_.replies[1].proven);
}

TEST_F(TwoRobots, RefuseAWrongTokenInTheirOwnWords) {
  Command sit = command(CommandKind::sit);
  sit.token = "wrong";
  const Robots::Received received = sent(sit);
  robots_.reply(1, received, false, "the token is wrong", "token_of_the_first");
  ASSERT_TRUE(eventually([&] {
    source_.poll(ignored_);
    return !ignored_.replies.empty();
  }));
  EXPECT_EQ(ignored_.replies.front().reason, "the token is wrong");
  EXPECT_FALSE(ignored_.replies.front().proven) << "it cannot prove that token";
}

/// A page that only looks may send commands with wrong tokens without end.
TEST_F(TwoRobots, AnswerASenderWhateverAnotherHasAskedSince) {
  Command first = command(CommandKind::sit, 5, 7);
  const Robots::Received received = sent(first);
  Command flood = command(CommandKind::walk, 6);
  flood.token = "wrong";
  for (int k = 0; k < 2000; ++k) source_.command(flood);
  ASSERT_TRUE(eventually([&] {
    robots_.accept(1, received);
    source_.poll(ignored_);
    return !ignored_.replies.empty();
  }));
  EXPECT_EQ(ignored_.replies.front().commander, 5u);
  EXPECT_EQ(ignored_.replies.front().sequence, 7u);
}

TEST_F(TwoRobots, DoNotAnswerASenderThatIsGone) {
  Command first = command(CommandKind::sit, 5);
  const Robots::Received received = sent(first);
  source_.forget(5);
  Command next = command(CommandKind::walk, 6);
  robots_.accept(1, received);
  ASSERT_TRUE(eventually([&] {
    source_.command(next);
    robots_.answer();
    source_.poll(ignored_);
    return !ignored_.replies.empty();
  }));
  for (const ReplySample& reply : ignored_.replies) EXPECT_EQ(reply.commander, 6u);
}

TEST_F(TwoRobots, AThirdWhoseTokenFileIsAFifoStopsNothingAndIsNamed) {
  const std::string fifo = folder_.file("fifo");
  ASSERT_EQ(mkfifo(fifo.c_str(), S_IRUSR | S_IWUSR), 0);
  robots_.begin(3, fifo);
  meet([this] {
    robots_.tick(3);
    return source_.talking().size() == 3;
  });
  source_.choose("0000000000000003");
  EXPECT_TRUE(warnings_.empty()) << "the tokens of the others are known: " << warnings_.front();
  source_.poll(ignored_);
  EXPECT_FALSE(source_.has_token());
  ASSERT_EQ(warnings_.size(), 1u) << "once per run that is shown";
  EXPECT_EQ(
      warnings_.front().find("cannot read " + fifo + ", the token of the robot; give --token-file FILE"), 0u)
      << warnings_.front();
}

TEST_F(TwoRobots, AreCommandedByTheirOwnTokensAfterAnotherIsChosen) {
  source_.choose("0000000000000002");
  source_.poll(ignored_);
  Taken walks;
  ASSERT_TRUE(eventually([&] {
    source_.command(command(CommandKind::walk));
    walks.merge(robots_.taken(telemetry::CommandKind::walk));
    return !walks.empty();
  }));
  EXPECT_EQ(walks, (Taken{{2, "token_of_the_second"}}));
}

}  // namespace
}  // namespace stilt::monitor
