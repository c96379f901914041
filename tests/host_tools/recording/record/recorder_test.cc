#include "host_tools/recording/record/recorder.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <utility>

#include "host_tools/recording/mcap/reader.h"
#include "tests/full_disk.h"
#include "tests/host_tools/recording/mcap/sample_file.h"
#include "tests/host_tools/recording/record_sample.h"
#include "tests/independent_readers/run_reader.h"

namespace stilt::record {
namespace {

using mcap::TemporaryFile;
using Json = nlohmann::json;

const Json& channel_of(const Json& found, const std::string& topic) {
  for (const Json& channel : found["channels"]) {
    if (channel["topic"] == topic) return channel;
  }
  throw std::runtime_error(topic);
}

TEST(Recorder, WhatItWroteIsReadByOthers) {
  const TemporaryFile file("recorder");
  {
    Recorder recorder(file.path(), {});
    recorder.take(configuration_sample(7, "a = 1\n", telemetry::kWireVersion, "amber3m", 0,
                                       "<robot name=\"amber3m\"/>"),
                  100);
    recorder.take(ticks_sample(7, 0, 20), 200);
    recorder.take(ticks_sample(7, 20, 20), 300);
    recorder.take(event_sample(7, "the robot walks"), 400);
    recorder.close();
  }
  const Json found = independent_readers::run_reader("read_mcap.cjs", {file.path(), "index"});
  ASSERT_EQ(found["messages"].size(), 4u);
  for (const auto& [message, sequence] : {std::pair{0u, 0}, {1u, 0}, {2u, 1}, {3u, 0}}) {  // by topic
    EXPECT_EQ(found["messages"][message]["sequence"], sequence) << message;
  }
  EXPECT_EQ(found["messages"][1]["log_time_ns"], "200");
  EXPECT_EQ(found["messages"][1]["publish_time_ns"], "1000");
  const Json ticks = channel_of(found, "/stilt/ticks");
  EXPECT_EQ(ticks["encoding"], "cdr");
  EXPECT_EQ(ticks["schema"], "stilt_msgs/msg/TickBatch");
  EXPECT_EQ(ticks["schema_encoding"], "ros2msg");
  EXPECT_EQ(found["messages"][1]["channel"], ticks["id"]);
  EXPECT_EQ(found["attachments"][0]["name"], "configuration_7.toml");
  EXPECT_EQ(found["attachments"][0]["text"], "a = 1\n");
  EXPECT_EQ(found["attachments"][1]["name"], "amber3m.urdf");
  EXPECT_EQ(found["attachments"][1]["text"], "<robot name=\"amber3m\"/>");
  EXPECT_EQ(found["metadata"][0][1]["version"], "9.9");
  EXPECT_EQ(found["metadata"][0][1]["wire_version"], "3");
}

TEST(Recorder, BytesAreKeptAsTheyCame) {
  const TemporaryFile file("bytes");
  const telemetry::Sample sample = ticks_sample(7, 0, 20);
  {
    Recorder recorder(file.path(), {});
    recorder.take(sample, 200);
  }
  mcap::Reader reader(file.path());
  const mcap::ReadMessage* read = reader.next();
  ASSERT_NE(read, nullptr);
  EXPECT_TRUE(std::ranges::equal(std::as_bytes(read->message.data), sample.cdr));
}

TEST(Recorder, CommandsAreNotKeptForTheyHoldTheToken) {
  const TemporaryFile file("commands");
  std::string token = "secret", name = "me", key;
  telemetry::Command command{};
  command.token = token.data();
  command.commander = name.data();
  command.key = key.data();
  {
    Recorder recorder(file.path(), {});
    recorder.take({&telemetry::kCommands, 0, 1, telemetry::encode(command)}, 1);
    EXPECT_EQ(recorder.messages(), 0u);
  }
  mcap::Reader reader(file.path());
  EXPECT_EQ(reader.next(), nullptr);
  for (const telemetry::Topic* topic : Recorder::topics()) EXPECT_NE(topic, &telemetry::kCommands);
}

TEST(Recorder, KeepsEveryThirdPlanForDrawing) {
  const TemporaryFile file("plans");
  Recorder recorder(file.path(), {});
  telemetry::Plan plan{};
  for (int i = 0; i < 7; ++i) recorder.take({&telemetry::kPlans, 0, 1, telemetry::encode(plan)}, i);
  EXPECT_EQ(recorder.messages(), 3u);
}

TEST(Recorder, KnowsWhichTicksAreMissingInWhichRun) {
  const TemporaryFile file("missing");
  Recorder recorder(file.path(), {});
  recorder.take(ticks_sample(7, 0, 20), 1);
  recorder.take(ticks_sample(8, 100, 20), 2);
  recorder.take(ticks_sample(7, 40, 20), 3);
  recorder.flush();
  EXPECT_EQ(recorder.runs().at(7).text(), "ticks 0 to 59, missing: 20 to 39");
  EXPECT_EQ(recorder.runs().at(8).text(), "ticks 100 to 119, missing: 0 to 99");
}

TEST(TickLedger, CountsEachTickOnce) {
  TickLedger ledger;
  EXPECT_EQ(ledger.text(), "no ticks");
  ledger.add(0, 10);
  ledger.add(5, 10);
  ledger.add(0, 3);
  EXPECT_EQ(ledger.count(), 15u);
  EXPECT_EQ(ledger.text(), "ticks 0 to 14, none missing");
  ledger.add(16, 1);
  EXPECT_EQ(ledger.count(), 16u);
  EXPECT_EQ(ledger.text(), "ticks 0 to 16, missing: 15");
}

TEST(TickLedger, ARecordThatBeganLateHasNoBreak) {
  TickLedger ledger;
  EXPECT_FALSE(ledger.has_break());
  ledger.add(100, 10);
  EXPECT_FALSE(ledger.has_break());
  ledger.add(111, 5);
  EXPECT_TRUE(ledger.has_break());
}

TEST(TopicNames, LoseThePrefixOfTheWireAndComeBack) {
  EXPECT_EQ(topic_in_record(telemetry::kJointStates), "/joint_states");
  for (const telemetry::Topic* topic : telemetry::topics()) {
    EXPECT_EQ(topic_of_record(topic_in_record(*topic)), topic);
  }
  EXPECT_EQ(topic_of_record("/somebody_elses"), nullptr);
}

TEST(Recorder, ARunOfAnotherWireVersionIsRecordedAndReported) {
  const TemporaryFile file("version");
  Recorder recorder(file.path(), {});
  recorder.take(configuration_sample(7, ""), 100);
  EXPECT_EQ(recorder.problem(), "");
  recorder.take(configuration_sample(171, "", telemetry::kWireVersion + 1), 100);
  EXPECT_EQ(
      recorder.problem(),
      "run 00000000000000ab has messages of wire version 4, but this stilt reads wire version 3; use the "
      "stilt of the same release as stiltd");
}

/// A file that may not grow stands for a full disk.
TEST(Recorder, TicksThatTheDiskDoesNotTakeAreNotCounted) {
  const TemporaryFile file("full");
  Recorder recorder(file.path(), {});
  recorder.take(ticks_sample(7, 0, 20), 200);
  recorder.flush();
  recorder.take(ticks_sample(7, 20, 20), 300);
  {
    const tests::FullDisk disk(recorder.bytes());
    EXPECT_THROW(recorder.flush(), std::runtime_error);
  }
  EXPECT_EQ(recorder.runs().at(7).text(), "ticks 0 to 19, none missing");
}

TEST(Recorder, TicksCountOnceTheirChunkIsWritten) {
  const TemporaryFile file("flushed");
  Recorder recorder(file.path(), {});
  recorder.take(ticks_sample(7, 0, 20), 200);
  EXPECT_TRUE(recorder.runs().empty());
  recorder.flush();
  EXPECT_EQ(recorder.runs().at(7).text(), "ticks 0 to 19, none missing");
  recorder.take(ticks_sample(7, 20, 20), 300);
  recorder.take(configuration_sample(7, "a = 1\n"), 400);  // its attachments follow the messages so far
  EXPECT_EQ(recorder.runs().at(7).text(), "ticks 0 to 39, none missing");
}

}  // namespace
}  // namespace stilt::record
