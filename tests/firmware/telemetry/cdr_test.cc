#include "firmware/telemetry/cdr.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

#include "firmware/telemetry/topics.h"

namespace stilt::telemetry {
namespace {

Cdr bytes(std::initializer_list<int> values) {
  Cdr cdr;
  for (const int value : values) cdr.push_back(static_cast<std::byte>(value));
  return cdr;
}

/// A speed command written out by hand: six doubles, 1.0 = 3f f0 00 ...
TEST(Cdr, a_twist_is_six_little_endian_doubles_behind_four_bytes) {
  Twist twist{};
  twist.linear.x = 1.0;
  Cdr expected = bytes({0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f});
  expected.resize(4 + 6 * 8);
  EXPECT_EQ(encode(twist), expected);
}

/// Strings: length with the final 0, characters, 0; numbers aligned to their size from the end of the header.
TEST(Cdr, a_reply_is_aligned_as_plain_cdr_asks) {
  CommandReply reply{};
  std::string commander = "ab";
  std::string reason = "no";
  std::string proof = "p";
  reply.run_id = 0x0102;
  reply.commander = commander.data();
  reply.number = 7;
  reply.accepted = false;
  reply.reason = reason.data();
  reply.time_s = 1.0;
  reply.proof = proof.data();
  EXPECT_EQ(encode(reply),
            bytes({0, 1, 0, 0,                     //
                   2, 1, 0, 0, 0,   0,   0,    0,  // run
                   3, 0, 0, 0, 'a', 'b', 0,    0,  // commander, a byte to fill up
                   7, 0, 0, 0, 0,   0,   0,    0,  // number
                   0, 0, 0, 0, 3,   0,   0,    0,    'n', 'o', 0, 0, 0, 0, 0, 0,  // accepted, reason
                   0, 0, 0, 0, 0,   0,   0xf0, 0x3f,                              //
                   2, 0, 0, 0, 'p', 0}));                                         // proof
}

TEST(Cdr, a_reply_of_a_big_endian_peer_reads_the_same) {
  const auto reply = decode<CommandReply>(
      bytes({0, 0, 0, 0,                  //
             0, 0, 0, 0, 0,   0,   1, 2,  // run
             0, 0, 0, 3, 'a', 'b', 0, 0,  // commander
             0, 0, 0, 0, 0,   0,   0, 7,  // number
             1, 0, 0, 0, 0,   0,   0, 3, 'n', 'o', 0, 0, 0, 0, 0, 0, 0x3f, 0xf0, 0, 0, 0, 0, 0, 0,  //
             0, 0, 0, 2, 'p', 0}));
  ASSERT_NE(reply, nullptr);
  EXPECT_EQ(reply->run_id, 0x0102u);
  EXPECT_STREQ(reply->commander, "ab");
  EXPECT_EQ(reply->number, 7u);
  EXPECT_TRUE(reply->accepted);
  EXPECT_STREQ(reply->reason, "no");
  EXPECT_EQ(reply->time_s, 1.0);
  EXPECT_STREQ(reply->proof, "p");
}

TEST(Cdr, a_message_reads_back) {
  PlannerCycle cycle{};
  cycle.run_id = 0xfedcba9876543210;
  cycle.tick = -1;
  cycle.cost = 0.1;
  cycle.checksum = 42;
  const auto read = decode<PlannerCycle>(encode(cycle));
  ASSERT_NE(read, nullptr);
  EXPECT_EQ(read->run_id, cycle.run_id);
  EXPECT_EQ(read->tick, -1);
  EXPECT_EQ(read->cost, 0.1);
  EXPECT_EQ(read->checksum, 42u);
}

TEST(Cdr, sequences_and_strings_read_back) {
  std::array<double, 3> values = {1, 2, 3};
  std::string key = "cost.base_x";
  std::string no_commander;
  Tuning tuning{};
  tuning.key = key.data();
  tuning.commander = no_commander.data();
  tuning.values = {3, 3, values.data(), false};
  const auto read = decode<Tuning>(encode(tuning));
  ASSERT_NE(read, nullptr);
  EXPECT_STREQ(read->key, "cost.base_x");
  EXPECT_TRUE(std::ranges::equal(span_of(read->values), values));
}

TEST(Cdr, bytes_that_end_too_early_or_name_another_encoding_are_no_message) {
  Twist twist{};
  const Cdr whole = encode(twist);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_EQ(decode<Twist>(std::span(whole).first(length)), nullptr) << length;
  }
  Cdr other = whole;
  other[1] = std::byte{3};  // parameter lists
  EXPECT_EQ(decode<Twist>(other), nullptr);
}

TEST(Topics, each_has_the_type_that_its_ros_name_says) {
  for (const Topic* topic : topics()) {
    const std::string ros(topic->ros_type);
    const auto slash = ros.find("/msg/");
    ASSERT_NE(slash, std::string::npos) << topic->name;
    EXPECT_EQ(ros.substr(0, slash) + "::msg::dds_::" + ros.substr(slash + 5) + "_", topic->type->m_typename);
    EXPECT_TRUE(topic->name.starts_with("rt/"));
    EXPECT_EQ(find_topic(topic->name), topic);
  }
  EXPECT_EQ(find_topic("rt/nothing"), nullptr);
}

}  // namespace
}  // namespace stilt::telemetry
