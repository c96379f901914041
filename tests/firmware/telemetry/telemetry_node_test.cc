// The robot's side of telemetry as a whole, with a commander on the wire.
#include "firmware/telemetry/telemetry_node.h"

#include <gtest/gtest.h>

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

/// Anna asks again and again for the largest value of a live tunable.
class TuningOrder {
 public:
  TuningOrder(const configuration::Configuration& configuration, const TelemetryNode& node,
              const Participant& peer)
      : tunable_(configuration::live_tunables(configuration).front()),
        token_(read_token(node.token_file()).value()),
        key_(tunable_.entry->name()),
        writer_(AnyWriter::open(peer, kCommands)) {
    command_.run_id = node.run_id();
    command_.token = token_.data();
    command_.commander = name_.data();
    command_.kind = static_cast<std::uint8_t>(CommandKind::tunable);
    command_.value = tunable_.maximum;
    command_.key = key_.data();
  }

  void send() {
    ++command_.number;
    ASSERT_TRUE(writer_.has_value());
    EXPECT_TRUE(writer_->write(&command_));
  }

  [[nodiscard]] const std::string& key() const { return key_; }

 private:
  configuration::LiveTunable tunable_;
  std::string token_, key_, name_ = "anna";
  Command command_{};
  std::expected<AnyWriter, std::string> writer_;
};

TEST_F(TelemetryNodeTest, ATuningNamesWhoAskedForIt) {
  TuningOrder order(configuration, *node, *peer);
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

TEST_F(TelemetryNodeTest, AnOrderThatCameWhileNobodyLookedForTheTimeOfAHeartbeatIsRefused) {
  TuningOrder order(configuration, *node, *peer);
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

}  // namespace
}  // namespace stilt::telemetry
