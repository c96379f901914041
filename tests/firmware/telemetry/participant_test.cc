#include "firmware/telemetry/participant.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "firmware/telemetry/reader.h"
#include "firmware/telemetry/udp_sockets.h"
#include "firmware/telemetry/writer.h"
#include "tests/firmware/telemetry/later_msgs.h"
#include "tests/own_domain.h"

namespace stilt::telemetry {
namespace {

using namespace std::chrono_literals;

/// Waits for something that comes, with a limit far beyond what it takes.
bool eventually(const std::function<bool()>& happened) {
  const auto end = std::chrono::steady_clock::now() + 60s;
  while (std::chrono::steady_clock::now() < end) {
    if (happened()) return true;
    std::this_thread::sleep_for(5ms);
  }
  return false;
}

Network network() { return {.domain = tests::own_domain()}; }

TEST(Participant, an_interface_that_does_not_exist_is_refused_with_its_name) {
  const auto participant = Participant::open({.interface = "stilt9"});
  ASSERT_FALSE(participant.has_value());
  EXPECT_NE(participant.error().find("\"stilt9\" does not exist"), std::string::npos);
}

TEST(Participant, without_the_documents_security_is_refused_and_the_missing_file_named) {
  const auto participant = Participant::open({.security_folder = "/nowhere"});
  ASSERT_FALSE(participant.has_value());
  EXPECT_NE(participant.error().find("/nowhere/ca_identity.pem is missing"), std::string::npos);
}

TEST(Participant, a_peer_that_cannot_be_is_refused_with_its_name) {
  for (const std::string peer : {"300.1.1.1", "a\"b"}) {
    const auto participant = Participant::open({.peers = "127.0.0.1, " + peer});
    ASSERT_FALSE(participant.has_value()) << peer;
    EXPECT_TRUE(participant.error().starts_with("telemetry.peers: \"" + peer + "\" is neither "))
        << participant.error();
  }
}

/// A participant whose sockets are not known could not be kept to its interface.
TEST(Participant, sockets_that_cannot_be_listed_are_an_error) {
  rlimit files{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &files), 0);
  const rlimit none = {0, files.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none), 0);
  const auto sockets = udp_sockets();
  const auto restricted = restrict_new_sockets({}, "lo");
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &files), 0);
  ASSERT_FALSE(sockets.has_value());
  EXPECT_NE(sockets.error().find("/proc/self/fd"), std::string::npos) << sockets.error();
  EXPECT_FALSE(restricted.has_value());
}

TEST(Participant, loopback_uses_no_multicast_and_meets_on_this_machine) {
  const std::string xml = to_xml({});
  EXPECT_NE(xml.find("NetworkInterface name=\"lo\""), std::string::npos);
  EXPECT_NE(xml.find("<AllowMulticast>false"), std::string::npos);
  EXPECT_NE(xml.find("<Peer address=\"127.0.0.1\"/>"), std::string::npos);
}

TEST(Participant, peers_are_taken_from_a_list_with_commas) {
  const std::string xml = to_xml({.interface = "eth0", .peers = "10.0.0.1, 10.0.0.2 "});
  EXPECT_NE(xml.find("<Peer address=\"10.0.0.1\"/><Peer address=\"10.0.0.2\"/>"), std::string::npos);
}

TEST(ReaderAndWriter, what_is_sent_arrives_byte_for_byte_and_in_order) {
  const auto robot = Participant::open(network());
  ASSERT_TRUE(robot.has_value()) << robot.error();
  auto writer = AnyWriter::open(*robot, kPlannerCycles);
  auto reader = Reader::open(*robot, kPlannerCycles);
  ASSERT_TRUE(writer && reader);
  ASSERT_TRUE(eventually([&] { return reader->senders() == 1; }));
  PlannerCycle cycle{};
  Cdr last;
  for (cycle.cycle = 1; cycle.cycle <= 100; ++cycle.cycle) {
    ASSERT_TRUE(writer->write(&cycle));
    last = encode(cycle);
  }
  std::vector<Sample> samples;
  ASSERT_TRUE(eventually([&] {
    reader->take([&](Sample&& sample) { samples.push_back(std::move(sample)); });
    return samples.size() >= 100;
  }));
  for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(samples[i].as<PlannerCycle>()->cycle, i + 1);
  EXPECT_EQ(samples.back().cdr, last);
  EXPECT_EQ(samples.back().topic, &kPlannerCycles);
  EXPECT_EQ(samples.back().as<Twist>(), nullptr);
}

TEST(ReaderAndWriter, a_message_of_a_later_release_with_one_more_field_is_read) {
  dds_topic_descriptor_t type = later_msgs_CommandReply__desc;
  type.m_typename = kCommandReplies.type->m_typename;
  Topic topic = kCommandReplies;
  topic.type = &type;
  const auto robot = Participant::open(network()), host = Participant::open(network());
  ASSERT_TRUE(robot && host);
  auto writer = AnyWriter::open(*robot, topic);
  auto reader = Reader::open(*host, kCommandReplies);
  ASSERT_TRUE(writer && reader);
  ASSERT_TRUE(eventually([&] { return writer->subscribers() == 1 && reader->senders() == 1; }));
  std::string commander = "me", reason = "no token", proof = "none", advice = "name one";
  const later_msgs_CommandReply_ reply = {
      7, commander.data(), 9, false, reason.data(), 1.5, proof.data(), advice.data()};
  ASSERT_TRUE(writer->write(&reply));
  std::vector<Sample> samples;
  ASSERT_TRUE(eventually([&] {
    reader->take([&](Sample&& sample) { samples.push_back(std::move(sample)); });
    return !samples.empty();
  }));
  const auto read = samples[0].as<CommandReply>();
  ASSERT_NE(read, nullptr);
  EXPECT_EQ(read->run_id, 7u);
  EXPECT_STREQ(read->commander, "me");
  EXPECT_EQ(read->number, 9u);
  EXPECT_STREQ(read->reason, "no token");
  EXPECT_EQ(read->time_s, 1.5);
  EXPECT_STREQ(read->proof, "none");
}

TEST(ReaderAndWriter, a_record_sends_late_subscribers_what_it_keeps) {
  const auto robot = Participant::open(network());
  ASSERT_TRUE(robot.has_value()) << robot.error();
  auto writer = AnyWriter::open(*robot, kPlannerCycles);
  ASSERT_TRUE(writer.has_value());
  PlannerCycle cycle{};
  for (cycle.cycle = 1; cycle.cycle <= 50; ++cycle.cycle) ASSERT_TRUE(writer->write(&cycle));
  auto reader = Reader::open(*robot, kPlannerCycles);
  ASSERT_TRUE(reader.has_value());
  int taken = 0;
  EXPECT_TRUE(eventually([&] { return (taken += reader->take([](Sample&&) {})) == 50; }));
}

}  // namespace
}  // namespace stilt::telemetry
