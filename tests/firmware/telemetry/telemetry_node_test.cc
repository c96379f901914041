// The robot's side of telemetry as a whole, with a commander on the wire.
#include "firmware/telemetry/telemetry_node.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "firmware/configuration/configuration.h"
#include "firmware/configuration/live.h"
#include "firmware/telemetry/writer.h"
#include "tests/firmware/telemetry/one_sample.h"
#include "tests/own_domain.h"
#include "tests/own_folder.h"

namespace stilt::telemetry {
namespace {

class TelemetryNodeTest : public ::testing::Test {
 protected:
  void SetUp() override {
    configuration.telemetry.domain = tests::own_domain();
    configuration.telemetry.token_file = folder.file("stilt/token");
    auto opened = TelemetryNode::open(configuration, {}, *mail);
    ASSERT_TRUE(opened.has_value()) << opened.error();
    node = std::move(*opened);
    ASSERT_TRUE(node->take_commands().has_value());
    control_loop::TickRecord tick;
    tick.time_ns = first_tick_ns;
    node->tick(tick);
    peer = Participant::open({.domain = tests::own_domain()});
    ASSERT_TRUE(peer.has_value()) << peer.error();
  }

  static std::int64_t now_ns(auto clock) {
    const auto now = decltype(clock)::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
  }

  static constexpr std::int64_t kHour_ns = 3'600'000'000'000;
  /// Housekeeping comes to it an hour later.
  std::int64_t first_tick_ns = now_ns(std::chrono::steady_clock()) - kHour_ns;
  tests::OwnFolder folder;
  configuration::Configuration configuration = configuration::load_robot("amber3m").value();
  std::unique_ptr<control_loop::Mailboxes> mail = std::make_unique<control_loop::Mailboxes>();
  std::unique_ptr<TelemetryNode> node;
  std::expected<Participant, std::string> peer;
};

TEST_F(TelemetryNodeTest, TheTimeOfDayIsThatOfTheFirstTickHoweverLateHousekeepingTakesIt) {
  const auto begun = testing::one_sample(*peer, kConfiguration, [] {}).as<ActiveConfiguration>();
  ASSERT_TRUE(begun);
  EXPECT_EQ(begun->start_clock_ns, first_tick_ns);
  const auto age_ns = static_cast<double>(now_ns(std::chrono::system_clock()) - begun->start_time_ns);
  EXPECT_NEAR(age_ns / static_cast<double>(kHour_ns), 1.0, 0.5);
}

/// Anna asks for the same again and again.
class Order {
 public:
  Order(const TelemetryNode& node, const Participant& peer, CommandKind kind, double value = 0,
        std::string key = {})
      : token_(read_token(node.token_file()).value()),
        key_(std::move(key)),
        writer_(AnyWriter::open(peer, kCommands)) {
    command_.run_id = node.run_id();
    command_.token = token_.data();
    command_.commander = name_.data();
    command_.kind = static_cast<std::uint8_t>(kind);
    command_.value = value;
    command_.key = key_.data();
  }
  Order(const Order&) = delete;
  Order& operator=(const Order&) = delete;

  void send() {
    ++command_.number;
    ASSERT_TRUE(writer_.has_value());
    EXPECT_TRUE(writer_->write(&command_));
  }

  [[nodiscard]] const std::string& key() const { return key_; }
  [[nodiscard]] std::uint64_t number() const { return command_.number; }

 private:
  std::string token_, key_, name_ = "anna";
  Command command_{};
  std::expected<AnyWriter, std::string> writer_;
};

/// For the largest value of a live tunable.
Order tuning_order(const configuration::Configuration& configuration, const TelemetryNode& node,
                   const Participant& peer) {
  const configuration::LiveTunable tunable = configuration::live_tunables(configuration).front();
  return {node, peer, CommandKind::tunable, tunable.maximum, tunable.entry->name()};
}

TEST_F(TelemetryNodeTest, ATuningNamesWhoAskedForIt) {
  Order order = tuning_order(configuration, *node, *peer);
  auto tunings = Reader::open(*peer, kTuning);
  ASSERT_TRUE(tunings.has_value());
  std::string key_tuned, tuned_by;
  for (int i = 0; i < 6000 && key_tuned.empty(); ++i) {
    order.send();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    static_cast<void>(node->operate({}));
    tunings->take([&](Sample&& sample) {
      const auto tuning = sample.as<Tuning>();
      if (!tuning || tuning->number == 0) return;  // as configured
      key_tuned = tuning->key;
      tuned_by = tuning->commander;
    });
  }
  EXPECT_EQ(key_tuned, order.key());
  EXPECT_EQ(tuned_by, "anna");
}

TEST_F(TelemetryNodeTest, AnOrderThatWaitedForHousekeepingLongerThanAHeartbeatMayIsRefused) {
  Order order = tuning_order(configuration, *node, *peer);
  static_cast<void>(node->operate({}));
  const auto reply = testing::one_sample(*peer, kCommandReplies, [&] {
                       order.send();
                       std::this_thread::sleep_for(std::chrono::duration<double>(
                           configuration.supervisor.heartbeat_timeout_s + 0.05));
                       static_cast<void>(node->operate({}));
                     }).as<CommandReply>();
  ASSERT_TRUE(reply);
  EXPECT_FALSE(reply->accepted);
  EXPECT_TRUE(std::string(reply->reason).starts_with("stiltd stood still for ")) << reply->reason;
}

TEST_F(TelemetryNodeTest, AResetNamesTheDampingThatIsLeft) {
  Order order(*node, *peer, CommandKind::reset);
  auto replies = Reader::open(*peer, kCommandReplies);
  ASSERT_TRUE(replies.has_value());
  const auto reason = [&] {
    std::optional<std::string> accepted;
    const std::uint64_t before = order.number();
    for (int i = 0; i < 6000 && !accepted; ++i) {
      order.send();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      static_cast<void>(node->operate({}));
      replies->take([&](Sample&& sample) {
        const auto reply = sample.as<CommandReply>();
        if (reply && reply->accepted && reply->number > before) accepted = reply->reason;
      });
    }
    return accepted.value_or("no answer");
  };
  control_loop::TickRecord tick;
  tick.time_ns = first_tick_ns;
  const auto pass = [&](double time_s, supervisor::State state, supervisor::FallbackLevel level) {
    ++tick.tick;
    tick.time_ns += std::llround(1e9 * time_s);
    tick.state = state;
    tick.level = level;
    node->tick(tick);
  };
  pass(5.0, supervisor::State::ready, supervisor::FallbackLevel::damp);
  pass(0.5, supervisor::State::fault, supervisor::FallbackLevel::damp);
  pass(0.5, supervisor::State::fault, supervisor::FallbackLevel::damp);
  EXPECT_EQ(reason(), "the joints are damped for 2 s first");
  pass(0.5, supervisor::State::fault, supervisor::FallbackLevel::off);
  EXPECT_EQ(reason(), "");
}

}  // namespace
}  // namespace stilt::telemetry
