#include "host_tools/recording/schema/message_types.h"

#include <gtest/gtest.h>

#include <fstream>
#include <stdexcept>

#include "firmware/telemetry/cdr.h"
#include "firmware/telemetry/topics.h"
#include "host_tools/recording/schema/decode.h"
#include "tests/host_tools/recording/schema/random_cdr.h"
#include "tests/independent_readers/run_reader.h"
#include "tests/own_folder.h"

namespace stilt::schema {
namespace {

constexpr unsigned kSeed = 20;
constexpr int kMessagesOfATopic = 20;

std::string hex(const std::vector<std::byte>& bytes) {
  std::string text;
  for (const std::byte byte : bytes) {
    text += "0123456789abcdef"[static_cast<unsigned>(byte) >> 4];
    text += "0123456789abcdef"[static_cast<unsigned>(byte) & 15];
  }
  return text;
}

TEST(MessageTypes, EveryTopicHasItsMessage) {
  for (const telemetry::Topic* topic : telemetry::topics()) {
    EXPECT_TRUE(own_messages().contains(std::string(topic->ros_type))) << topic->name;
  }
}

TEST(MessageTypes, AreThoseThatTheProgramSends) {
  RandomCdr random(own_messages(), kSeed);
  for (const telemetry::Topic* topic : telemetry::topics()) {
    for (int i = 0; i < kMessagesOfATopic; ++i) {
      const telemetry::Cdr cdr = random.write(std::string(topic->ros_type));
      std::vector<std::byte> memory(topic->type->m_size);
      ASSERT_TRUE(telemetry::internal::decode(*topic->type, cdr, memory.data()))
          << topic->name << ", seed " << kSeed;
      EXPECT_EQ(hex(telemetry::internal::encode(*topic->type, memory.data())), hex(cdr))
          << topic->name << ", seed " << kSeed;
      dds_sample_free(memory.data(), topic->type, DDS_FREE_CONTENTS);
    }
  }
}

TEST(MessageTypes, AreReadByOthersFromTheirText) {
  RandomCdr random(own_messages(), kSeed + 1);
  nlohmann::json messages;
  for (const telemetry::Topic* topic : telemetry::topics()) {
    const std::string name(topic->ros_type);
    for (int i = 0; i < kMessagesOfATopic; ++i) {
      messages.push_back({{"schema", ros2msg_text(own_messages(), name)}, {"cdr", hex(random.write(name))}});
    }
  }
  const tests::OwnFolder folder;
  const std::string file = folder.file("messages.json");
  std::ofstream(file) << messages;
  const nlohmann::json read = independent_readers::run_reader("rewrite_cdr.cjs", {file});
  ASSERT_EQ(read.size(), messages.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i]["cdr"], messages[i]["cdr"])
        << messages[i]["schema"].get<std::string>() << read[i]["message"];
  }
}

TEST(MessageTypes, TextIsReadBack) {
  for (const telemetry::Topic* topic : telemetry::topics()) {
    const std::string name(topic->ros_type);
    const std::string text = ros2msg_text(own_messages(), name);
    EXPECT_EQ(ros2msg_text(parse_ros2msg(text, name), name), text);
  }
}

TEST(MessageTypes, TextIsThatOfRos) {
  EXPECT_EQ(ros2msg_text(own_messages(), "geometry_msgs/msg/Twist"),
            "geometry_msgs/Vector3 linear\n"
            "geometry_msgs/Vector3 angular\n"
            "================================================================================\n"
            "MSG: geometry_msgs/Vector3\n"
            "float64 x\nfloat64 y\nfloat64 z\n");
}

TEST(MessageTypes, TextByOthersIsRead) {
  const MessageTypes types = parse_ros2msg(
      "# a comment\nbyte LEVEL=3\nint32 OTHER = 4\n\nHeader header  # when\nPoint[] points\nbyte[<=4] flags\n"
      "float64[9] k\n====\nMSG: std_msgs/Header\nstring frame_id\n====\nMSG: a/Point\nfloat32 x\n",
      "a/msg/Cloud");
  const std::vector<Field>& fields = types.at("a/msg/Cloud");
  ASSERT_EQ(fields.size(), 4u);
  EXPECT_EQ(fields[0].type, "std_msgs/msg/Header");
  EXPECT_EQ(fields[1].type, "a/msg/Point");
  EXPECT_EQ(fields[1].shape, Shape::sequence);
  EXPECT_EQ(fields[2].type, "uint8");
  EXPECT_EQ(fields[2].shape, Shape::sequence);
  EXPECT_EQ(fields[3].count, 9u);
  EXPECT_TRUE(types.contains("a/msg/Point"));
}

TEST(MessageTypes, ADefinitionThatNoMessageCanHaveIsRefusedWithItsDefect) {
  const auto complaint = [](const std::string& text) -> std::string {
    try {
      static_cast<void>(parse_ros2msg(text, "a/msg/B"));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(complaint("B x\n"), "the message a/msg/B contains itself");
  EXPECT_EQ(complaint("C x\n====\nMSG: a/C\nB[] y\n"), "the message a/msg/B contains itself");
  EXPECT_EQ(complaint("c/D x\n"), "the field x of a/msg/B has the type c/msg/D, which is not defined");
  for (const std::string count : {"N", "-1", "4x", "99999999999999999999999"}) {
    EXPECT_EQ(complaint("int32[" + count + "] x\n"),
              "the field x has the type int32[" + count + "], whose number of values is none");
  }
  std::string deep = "M0 x\n";
  for (int i = 0; i < 1000; ++i) {
    deep += "====\nMSG: a/M" + std::to_string(i) + "\nM" + std::to_string(i + 1) + " x\n";
  }
  EXPECT_EQ(complaint(deep + "====\nMSG: a/M1000\nbool x\n"), "its messages contain each other 100 times");
  EXPECT_EQ(complaint("C x\nC y\n====\nMSG: a/C\nbool z\n"), "accepted") << "used twice, not in itself";
}

/// A message of every basic type, an array and a sequence, in CDR by hand.
TEST(Decode, EveryTypeIsReadWhereItsAlignmentPutsIt) {
  const MessageTypes types = parse_ros2msg(
      "bool b\nint8 a\nuint16 c\nint32 d\nuint64 e\nfloat32 f\nfloat64 g\nstring s\nint16[2] h\nuint8[] k\n",
      "a/msg/All");
  const std::vector<std::uint8_t> cdr = {0,    1,    0,    0,                           // little endian
                                         1,    0xff, 2,    1,                           // true, -1, 0x0102
                                         0xfe, 0xff, 0xff, 0xff,                        // -2
                                         7,    0,    0,    0,    0,   0,   0,    1,     // 2^56 + 7
                                         0xcd, 0xcc, 0xcc, 0x3d,                        // 0.1 as float
                                         0,    0,    0,    0,                           // padding
                                         0,    0,    0,    0,    0,   0,   0xf8, 0xbf,  // -1.5
                                         3,    0,    0,    0,    'h', 'i', 0,           // "hi"
                                         0,                                             // padding
                                         0xff, 0x7f, 0,    0x80,                        // 32767, -32768
                                         2,    0,    0,    0,    8,   9};
  const auto json = decode(types, "a/msg/All", cdr);
  EXPECT_EQ(json, nlohmann::ordered_json::parse(
                      R"({"b": true, "a": -1, "c": 258, "d": -2, "e": 72057594037927943, "f": 0.1, "g": -1.5,
                          "s": "hi", "h": [32767, -32768], "k": [8, 9]})"));
}

TEST(Decode, WhatEndsTooEarlyOrIsBigEndianIsRefused) {
  const MessageTypes types = parse_ros2msg("Nothing[] many\nuint32 n\n====\nMSG: a/Nothing\n", "a/msg/Short");
  const auto refuses = [&types](const std::vector<std::uint8_t>& cdr) {
    EXPECT_THROW(static_cast<void>(decode(types, "a/msg/Short", cdr)), std::runtime_error);
  };
  EXPECT_EQ(decode(types, "a/msg/Short", std::vector<std::uint8_t>{0, 1, 0, 0, 0, 0, 0, 0, 5, 0, 0, 0})["n"],
            5);
  refuses({});
  refuses({0, 1, 0});
  refuses({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 5});    // big endian
  refuses({0, 1, 0, 0, 0, 0, 0, 0, 5, 0, 0});       // three bytes of four
  refuses({0, 1, 0, 0, 100, 0, 0, 0, 5, 0, 0, 0});  // a hundred empty messages in eight bytes
}

TEST(MessageTypes, TypesOfIdlHaveTheirNamesOfRos) {
  const MessageTypes types = parse_idl(
      "module a { module msg { module dds_ { @topic struct All_ { // all of them\n"
      "boolean b; octet o; short s; unsigned short t; long l; unsigned long m; long long n; unsigned long "
      "long p;\n"
      "float f; double d; string w; sequence<unsigned long> q; double x[3]; }; /* done */ }; }; };");
  EXPECT_EQ(ros2msg_text(types, "a/msg/All"),
            "bool b\nuint8 o\nint16 s\nuint16 t\nint32 l\nuint32 m\nint64 n\nuint64 p\nfloat32 f\nfloat64 d\n"
            "string w\nuint32[] q\nfloat64[3] x\n");
}

TEST(MessageTypes, AMessageUsedTwiceIsDescribedOnce) {
  const std::string text = ros2msg_text(own_messages(), "nav_msgs/msg/Odometry");
  const std::string heading = "MSG: geometry_msgs/Vector3\n";
  const std::size_t first = text.find(heading);
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(text.find(heading, first + 1), std::string::npos);
}

TEST(MessageTypes, IdlThatIsNotUnderstoodIsRefused) {
  EXPECT_THROW(static_cast<void>(parse_idl("union U switch(long) {};")), std::runtime_error);
  EXPECT_THROW(static_cast<void>(parse_idl("struct S_ { Unknown_ u; };")), std::runtime_error);
  EXPECT_THROW(static_cast<void>(parse_idl("struct S_ { double d }")), std::runtime_error);
}

}  // namespace
}  // namespace stilt::schema
