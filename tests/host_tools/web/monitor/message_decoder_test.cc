#include "host_tools/web/monitor/message_decoder.h"

#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "firmware/telemetry/tick_batch.h"
#include "firmware/telemetry/wire_version.h"

namespace stilt::monitor {
namespace {

/// Keeps what it is given.
class Kept final : public SampleSink {
 public:
  void configuration(const ConfigurationSample& sample) override { configurations.push_back(sample); }
  void tick(const TickSample& sample) override { ticks.push_back(sample); }
  void plan(const PlanSample&) override {}
  void planner(const PlannerSample& sample) override { cycles.push_back(sample); }
  void supervisor(const SupervisorSample& sample) override { states.push_back(sample); }
  void event(const EventSample& sample) override { events.push_back(sample); }
  void timing(const TimingSample&) override {}
  void truth(const TruthSample&) override {}
  void reply(const ReplySample&) override {}

  std::vector<ConfigurationSample> configurations;
  std::vector<TickSample> ticks;
  std::vector<PlannerSample> cycles;
  std::vector<SupervisorSample> states;
  std::vector<EventSample> events;
};

template <class Message>
telemetry::Sample on(const telemetry::Topic& topic, const Message& message) {
  telemetry::Sample sample;
  sample.topic = &topic;
  sample.cdr = telemetry::encode(message);
  return sample;
}

/// stiltd of that run, started at that time of day, its clock beginning at 5 s, with one tunable.
telemetry::Sample configuration(std::uint64_t run_id, std::int64_t start_time_ns,
                                std::uint32_t wire_version = telemetry::kWireVersion) {
  char empty[] = "", robot[] = "amber3m", key[] = "cost.base_z", file[] = "/run/token";
  std::array<stilt_msgs_msg_dds__Tunable_, 1> tunables{{{key, empty, empty, 0.0, 1000.0, 400.0}}};
  telemetry::ActiveConfiguration message{};
  message.run_id = run_id;
  message.start_time_ns = start_time_ns;
  message.start_clock_ns = 5'000'000'000;
  message.robot = robot;
  message.configuration = message.version = message.compiler = message.instruction_set = message.realtime =
      message.urdf = empty;
  message.token_file = file;
  message.torque_rate_hz = 2000.0;
  message.plan_rate_hz = 400.0;
  message.tunables._buffer = tunables.data();
  message.tunables._length = message.tunables._maximum = 1;
  message.wire_version = wire_version;
  return on(telemetry::kConfiguration, message);
}

telemetry::Sample one_tick(std::uint64_t run_id, std::uint64_t tick) {
  telemetry::TickBatchBuilder builder;
  control_loop::TickRecord record;
  record.tick = tick;
  record.time_ns = 5'000'000'000 + static_cast<std::int64_t>(tick) * 1'000'000;
  builder.add(record);
  builder.message().run_id = run_id;
  return on(telemetry::kTicks, builder.message());
}

/// The value of the tunable, or none.
telemetry::Sample tuning(std::uint64_t run_id, std::optional<double> value) {
  char empty[] = "";
  telemetry::Tuning message{};
  message.run_id = run_id;
  message.number = 1;
  message.key = message.commander = empty;
  if (value) message.values._buffer = &*value;
  message.values._length = message.values._maximum = value ? 1 : 0;
  return on(telemetry::kTuning, message);
}

telemetry::Sample event(std::uint64_t run_id, std::string text) {
  char name[] = "";
  telemetry::Event message{};
  message.run_id = run_id;
  message.name = name;
  message.text = text.data();
  return on(telemetry::kEvents, message);
}

TEST(MessageDecoder, TicksCountTheirTimeFromTheControllersStart) {
  MessageDecoder decoder;
  Kept kept;
  decoder.take(configuration(1, 100), kept);
  decoder.take(one_tick(1, 250), kept);
  ASSERT_EQ(kept.ticks.size(), 1u);
  EXPECT_NEAR(kept.ticks[0].time_s, 0.25, 1e-12);
  EXPECT_EQ(kept.ticks[0].record.tick, 250u);
}

TEST(MessageDecoder, TheRatesAreThoseOfTheRun) {
  MessageDecoder decoder;
  Kept kept;
  decoder.take(configuration(1, 100), kept);
  decoder.take(one_tick(1, 250), kept);
  EXPECT_EQ(kept.configurations.at(0).tick_rate_hz, 2000.0);
  EXPECT_EQ(kept.configurations.at(0).plan_rate_hz, 400.0);
  EXPECT_EQ(kept.ticks.at(0).tick_rate_hz, 2000.0);
}

TEST(MessageDecoder, SamplesWithoutAKnownRunAreLeftOutAndNotCalledAnothers) {
  MessageDecoder decoder;
  Kept kept;
  decoder.take(one_tick(1, 0), kept);
  EXPECT_TRUE(kept.ticks.empty());
  EXPECT_EQ(decoder.of_others(), 0u);
}

TEST(MessageDecoder, OfARecordTheNewerRunTakesOverAndAnOlderOneDoesNot) {
  MessageDecoder decoder(Follow::newest);
  Kept kept;
  decoder.take(configuration(1, 100), kept);
  decoder.take(configuration(2, 200), kept);
  decoder.take(configuration(3, 150), kept);
  EXPECT_EQ(decoder.run_id(), 2u);
  ASSERT_EQ(kept.configurations.size(), 2u);
  EXPECT_EQ(kept.configurations[1].run_id, "0000000000000002");
}

TEST(MessageDecoder, ARunThatTalksIsFollowedHoweverLongAnotherTalksToo) {
  MessageDecoder decoder;
  Kept kept;
  decoder.take(configuration(1, 100), kept);
  decoder.take(configuration(2, 200), kept);
  for (std::uint64_t tick = 0; tick < 1000; ++tick) {
    decoder.take(one_tick(2, 2 * tick), kept);
    if (tick % (MessageDecoder::kSilentBatches - 1) == 0) decoder.take(one_tick(1, tick), kept);
  }
  EXPECT_EQ(decoder.run_id(), 1u);
  EXPECT_EQ(kept.configurations.size(), 1u);
  for (const TickSample& tick : kept.ticks) {
    EXPECT_EQ(tick.record.tick % (MessageDecoder::kSilentBatches - 1), 0u);
  }
  const auto runs = decoder.runs();
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_TRUE(runs[0].sends && runs[1].sends);
  EXPECT_EQ(runs[1].token_file, "/run/token");
}

TEST(MessageDecoder, AfterASilentRunTheOneThatTalksIsFollowedFromItsFirstTickKept) {
  MessageDecoder decoder;
  Kept kept;
  decoder.take(configuration(1, 100), kept);
  decoder.take(one_tick(1, 0), kept);
  decoder.take(configuration(2, 200), kept);
  for (std::uint64_t tick = 0; tick < MessageDecoder::kSilentBatches; ++tick) {
    EXPECT_EQ(decoder.run_id(), 1u) << tick;
    decoder.take(one_tick(2, tick), kept);
  }
  EXPECT_EQ(decoder.run_id(), 2u);
  ASSERT_EQ(kept.ticks.size(), 1 + MessageDecoder::kSilentBatches);
  EXPECT_EQ(kept.ticks[1].record.tick, 0u);
  EXPECT_FALSE(decoder.runs()[0].sends);
  EXPECT_EQ(decoder.of_others(), 0u);
}

TEST(MessageDecoder, AnOlderRunThatStillTalksIsFollowedAgainAfterTheNewerHasEnded) {
  MessageDecoder decoder;
  Kept kept;
  decoder.take(configuration(2, 200), kept);
  decoder.take(one_tick(2, 0), kept);
  decoder.take(configuration(1, 100), kept);
  for (std::uint64_t tick = 0; tick < MessageDecoder::kSilentBatches; ++tick) {
    decoder.take(one_tick(1, tick), kept);
  }
  EXPECT_EQ(decoder.run_id(), 1u);
  ASSERT_EQ(kept.configurations.size(), 2u);
  EXPECT_EQ(kept.configurations[1].run_id, "0000000000000001");
}

TEST(MessageDecoder, ARunThatIsChosenIsFollowedWithTheTunablesItHasNow) {
  MessageDecoder decoder;
  Kept kept;
  decoder.take(configuration(1, 100), kept);
  decoder.take(configuration(2, 200), kept);
  decoder.take(tuning(2, 350.0), kept);
  decoder.take(one_tick(1, 0), kept);
  decoder.choose(3, kept);
  EXPECT_EQ(decoder.run_id(), 1u) << "there is no such run";
  decoder.choose(2, kept);
  EXPECT_EQ(decoder.run_id(), 2u);
  EXPECT_EQ(kept.configurations.back().tunables.at(0).value, 350.0);
  decoder.take(one_tick(1, 1), kept);
  decoder.take(one_tick(2, 9), kept);
  EXPECT_EQ(kept.ticks.back().record.tick, 9u);
  EXPECT_EQ(decoder.of_others(), 2u) << "of run 2 its tuning, of run 1 a tick";
}

std::vector<std::string> texts_of(const Kept& kept) {
  std::vector<std::string> texts;
  for (const EventSample& event : kept.events) texts.push_back(event.text);
  return texts;
}

TEST(MessageDecoder, ARunThatIsChosenHasTheEventsOfItsPastAndOfNoOtherRun) {
  MessageDecoder decoder;
  Kept kept;
  decoder.take(configuration(1, 100), kept);
  decoder.take(event(2, "ready"), kept);
  decoder.take(one_tick(1, 0), kept);
  decoder.take(configuration(2, 200), kept);
  decoder.take(event(2, "walk"), kept);
  decoder.take(event(1, "stand"), kept);
  decoder.take(one_tick(1, 1), kept);
  EXPECT_EQ(texts_of(kept), std::vector<std::string>{"stand"});
  EXPECT_EQ(decoder.of_others(), 0u) << "they are kept";
  kept.events.clear();
  decoder.choose(2, kept);
  decoder.take(event(2, "sit"), kept);
  EXPECT_EQ(texts_of(kept), (std::vector<std::string>{"ready", "walk", "sit"}));
  kept.events.clear();
  decoder.choose(1, kept);
  EXPECT_EQ(texts_of(kept), std::vector<std::string>{"stand"}) << "the first run again";
}

TEST(MessageDecoder, EventsOfTheFirstRunThatComeBeforeItsConfigurationAreKept) {
  MessageDecoder decoder;
  Kept kept;
  decoder.take(event(1, "ready"), kept);
  EXPECT_TRUE(kept.events.empty());
  decoder.take(configuration(1, 100), kept);
  EXPECT_EQ(texts_of(kept), std::vector<std::string>{"ready"});
}

TEST(MessageDecoder, OfARunTheNewestEventsAreKeptAndOfManyRunsThoseOfTheOneThatIsFollowed) {
  MessageDecoder decoder;
  Kept kept;
  decoder.take(configuration(1, 100), kept);
  decoder.take(event(1, "stand"), kept);
  for (std::uint64_t run = 100; run < 200; ++run) decoder.take(event(run, "other"), kept);
  decoder.take(configuration(2, 200), kept);
  for (int number = 0; number < 1000; ++number) decoder.take(event(2, std::to_string(number)), kept);
  kept.events.clear();
  decoder.choose(2, kept);
  EXPECT_EQ(kept.events.size(), 256u);
  EXPECT_EQ(kept.events.back().text, "999");
  kept.events.clear();
  decoder.choose(1, kept);
  EXPECT_EQ(texts_of(kept), std::vector<std::string>{"stand"});
}

TEST(MessageDecoder, RunsThatEndedLongAgoAreForgottenAndTheOneThatIsFollowedIsNot) {
  MessageDecoder decoder;
  Kept kept;
  for (std::uint64_t run = 1; run <= 100; ++run) decoder.take(configuration(run, 100), kept);
  EXPECT_LE(decoder.runs().size(), 16u);
  EXPECT_EQ(decoder.runs().front().run_id, 1u);
  EXPECT_EQ(decoder.runs().back().run_id, 100u);
}

TEST(MessageDecoder, OnlyASecondControllerThatSendsWhileTheFirstDoesIsCounted) {
  MessageDecoder decoder;
  Kept kept;
  decoder.take(configuration(1, 100), kept);
  decoder.take(one_tick(1, 0), kept);
  decoder.take(one_tick(9, 0), kept);
  EXPECT_EQ(decoder.of_others(), 0u) << "it may be the next run, whose configuration is on its way";
  decoder.take(one_tick(1, 1), kept);
  EXPECT_EQ(decoder.of_others(), 1u);
  EXPECT_EQ(kept.ticks.size(), 2u);
}

TEST(MessageDecoder, ARunOfAnotherWireVersionIsNotFollowedAndOneEventStatesIt) {
  MessageDecoder decoder;
  Kept kept;
  for (int times = 0; times < 3; ++times) decoder.take(configuration(0xab, 100, 4), kept);
  for (std::uint64_t tick = 0; tick < 3000; ++tick) decoder.take(one_tick(0xab, tick), kept);
  EXPECT_TRUE(kept.configurations.empty());
  EXPECT_TRUE(kept.ticks.empty());
  ASSERT_EQ(kept.events.size(), 1u);
  EXPECT_EQ(decoder.refused(), kept.events[0].text);
  EXPECT_TRUE(kept.events[0].serious);
  EXPECT_EQ(
      kept.events[0].text,
      "run 00000000000000ab has messages of wire version 4, but this stilt reads wire version 3; use the "
      "stilt of the same release as stiltd");
}

TEST(MessageDecoder, OfTwoRunsThatCannotBeReadEachHasOneEventHoweverTheyAlternate) {
  MessageDecoder decoder;
  Kept kept;
  for (std::uint64_t tick = 0; tick < 5000; ++tick) {
    decoder.take(one_tick(0xa, tick), kept);
    decoder.take(one_tick(0xb, tick), kept);
  }
  EXPECT_EQ(kept.events.size(), 2u);
  EXPECT_TRUE(decoder.refused().starts_with("run 000000000000000b sends ticks")) << decoder.refused();
  decoder.take(configuration(1, 100), kept);
  EXPECT_EQ(decoder.refused(), "");
}

TEST(MessageDecoder, TwoSecondsOfTicksWithoutAConfigurationGiveOneEvent) {
  MessageDecoder decoder;
  Kept kept;
  for (std::uint64_t tick = 0; tick < 1999; ++tick) decoder.take(one_tick(0xab, tick), kept);
  EXPECT_TRUE(kept.events.empty());
  for (std::uint64_t tick = 1999; tick < 9000; ++tick) decoder.take(one_tick(0xab, tick), kept);
  ASSERT_EQ(kept.events.size(), 1u);
  EXPECT_TRUE(kept.events[0].text.starts_with("run 00000000000000ab sends ticks but no configuration"))
      << kept.events[0].text;
  decoder.take(configuration(0xab, 100), kept);
  decoder.take(one_tick(0xab, 9000), kept);
  EXPECT_EQ(kept.ticks.size(), 1u) << "a configuration that comes late is followed";
}

TEST(MessageDecoder, TunablesThatChangeComeAsTheConfigurationAnew) {
  MessageDecoder decoder;
  Kept kept;
  decoder.take(configuration(1, 100), kept);
  decoder.take(tuning(1, 350.0), kept);
  ASSERT_EQ(kept.configurations.size(), 2u);
  EXPECT_EQ(kept.configurations[0].tunables.at(0).value, 400.0);
  EXPECT_EQ(kept.configurations[1].tunables.at(0).value, 350.0);
  decoder.take(tuning(1, {}), kept);
  EXPECT_EQ(kept.configurations.size(), 2u) << "as many values as tunables, or none of them";
}

TEST(MessageDecoder, BytesThatAreNoMessageAreLeftOut) {
  MessageDecoder decoder;
  Kept kept;
  decoder.take(configuration(1, 100), kept);
  telemetry::Sample sample = one_tick(1, 0);
  sample.cdr.resize(sample.cdr.size() / 2);
  decoder.take(sample, kept);
  sample.cdr.clear();
  decoder.take(sample, kept);
  EXPECT_TRUE(kept.ticks.empty());
}

/// A message of the supervisor of run 1 with another number at one place.
telemetry::Sample supervisor_with(std::uint8_t telemetry::Supervisor::* place, std::uint8_t number) {
  char empty[] = "";
  telemetry::Supervisor message{};
  message.run_id = 1;
  message.commander = message.state_name = message.fallback_level_name = empty;
  message.*place = number;
  return on(telemetry::kSupervisor, message);
}

/// Anybody on the network can send them, and names are looked up by them.
TEST(MessageDecoder, ANumberThatIsNoEnumeratorIsRefusedWithItsMessage) {
  using telemetry::Supervisor;
  MessageDecoder decoder;
  Kept kept;
  decoder.take(configuration(1, 100), kept);
  struct Place {
    std::uint8_t Supervisor::* place;
    std::uint8_t last;
  };
  std::size_t taken = 0;
  for (const auto& [place, last] : {Place{&Supervisor::state, 10}, Place{&Supervisor::fallback_level, 6},
                                    Place{&Supervisor::reaction, 6}, Place{&Supervisor::gait, 2}}) {
    decoder.take(supervisor_with(place, last), kept);
    EXPECT_EQ(kept.states.size(), ++taken);
    decoder.take(supervisor_with(place, static_cast<std::uint8_t>(last + 1)), kept);
    decoder.take(supervisor_with(place, 255), kept);
    EXPECT_EQ(kept.states.size(), taken);
  }
  telemetry::PlannerCycle cycle{};
  cycle.run_id = 1;
  for (const std::uint8_t status : {std::uint8_t{5}, std::uint8_t{6}, std::uint8_t{255}}) {
    cycle.status = status;
    decoder.take(on(telemetry::kPlannerCycles, cycle), kept);
  }
  EXPECT_EQ(kept.cycles.size(), 1u);
  telemetry::TickBatchBuilder builder;
  control_loop::TickRecord record;
  record.emergency_stop = static_cast<hal::EmergencyStopState>(4);
  builder.add(record);
  builder.message().run_id = 1;
  decoder.take(on(telemetry::kTicks, builder.message()), kept);
  EXPECT_TRUE(kept.ticks.empty());
}

}  // namespace
}  // namespace stilt::monitor
