#include "host_tools/recording/mcap/reader.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/host_tools/recording/mcap/sample_file.h"

namespace stilt::mcap {
namespace {

/// Changes the second byte of the text, which the file holds, in its first place.
void damage(const TemporaryFile& file, const std::string& text) {
  Bytes bytes = file.bytes();
  const auto at = std::ranges::search(bytes, text).begin();
  ASSERT_NE(at, bytes.end());
  at[1] ^= 0x40;
  file.set_bytes(bytes);
}

/// A file of these records, shorter than 256 bytes each, that was closed properly.
Bytes file_of(const std::vector<std::pair<Op, Bytes>>& records) {
  Bytes bytes(std::begin(kMagic), std::end(kMagic));
  const auto put = [&bytes](Op op, const Bytes& body) {
    bytes.push_back(static_cast<std::uint8_t>(op));
    bytes.push_back(static_cast<std::uint8_t>(body.size()));
    bytes.resize(bytes.size() + 7);
    bytes.insert(bytes.end(), body.begin(), body.end());
  };
  for (const auto& [op, body] : records) put(op, body);
  put(Op::footer, Bytes(20));
  bytes.insert(bytes.end(), std::begin(kMagic), std::end(kMagic));
  return bytes;
}

const Bytes kChannel1 = {1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};  // no schema, no words

/// A chunk of these records without times, check sum and compression.
Bytes chunk_of(const Bytes& records) {
  Bytes chunk(40 + records.size());
  chunk[16] = chunk[32] = static_cast<std::uint8_t>(records.size());
  std::ranges::copy(records, chunk.begin() + 40);
  return chunk;
}

/// Reads all, and checks that the messages are the first of the sample's.
int count_messages(Reader& reader) {
  int count = 0;
  while (const ReadMessage* read = reader.next()) {
    const Message& message = read->message;
    EXPECT_EQ(message.sequence, static_cast<std::uint32_t>(count));
    EXPECT_EQ(message.log_time_ns, 1'000'000 + count * 100);
    EXPECT_EQ(message.publish_time_ns, 900'000 + count);
    EXPECT_EQ(Bytes(message.data.begin(), message.data.end()), sample_data(count));
    EXPECT_EQ(read->channel->topic, count % 2 == 0 ? "/first" : "/second");
    EXPECT_EQ(read->schema == nullptr ? "" : read->schema->name, count % 2 == 0 ? "pkg/msg/Number" : "");
    ++count;
  }
  return count;
}

class EveryCompression : public testing::TestWithParam<Compression> {};

TEST_P(EveryCompression, GivesBackWhatTheWriterWasGiven) {
  const TemporaryFile file("reader");
  {
    Writer writer(file.path(), {.compression = GetParam()});
    write_sample(writer);
    writer.close();
  }
  Reader reader(file.path());
  EXPECT_EQ(count_messages(reader), kSampleMessages);
  EXPECT_TRUE(reader.complete());
  EXPECT_TRUE(reader.problems().empty());
  ASSERT_EQ(reader.attachments().size(), 2u);
  EXPECT_EQ(reader.attachments()[0].data, "a = 1\n");
  EXPECT_EQ(reader.attachments()[1].name, "robot.urdf");
  ASSERT_EQ(reader.metadata().size(), 1u);
  EXPECT_EQ(reader.metadata()[0].entries.at("number"), "17");
  EXPECT_EQ(reader.channels().at(0).metadata.at("frame"), "world");
  EXPECT_EQ(reader.channels().at(0).schema_id, 1u);
  EXPECT_EQ(reader.channels().at(1).schema_id, 0u);
}

INSTANTIATE_TEST_SUITE_P(Reader, EveryCompression,
                         testing::Values(Compression::none, Compression::lz4, Compression::zstd));

TEST(Reader, AFileCutOffAnywhereGivesAllWholeChunksBeforeTheCut) {
  const TemporaryFile file("cut");
  std::vector<std::uint64_t> flushed;  // sizes after each chunk
  {
    Writer writer(file.path());
    const std::uint16_t channel = writer.add_channel(0, "/first", "json");
    for (std::uint32_t i = 0; i < 20; ++i) {
      writer.write({channel, i, i, i, sample_data(3)});
      if (i % 5 != 4) continue;
      writer.flush();
      flushed.push_back(writer.bytes_written());
    }
    writer.close();
  }
  const Bytes whole = file.bytes();
  for (std::size_t size = sizeof kMagic; size < whole.size() - sizeof kMagic; ++size) {
    file.set_bytes(ByteView(whole).first(size));
    Reader reader(file.path());
    std::size_t messages = 0;
    while (reader.next() != nullptr) ++messages;
    const auto chunks = std::ranges::count_if(flushed, [&](std::uint64_t end) { return end <= size; });
    EXPECT_GE(messages, static_cast<std::size_t>(chunks) * 5) << size;
    EXPECT_EQ(messages % 5, 0u) << size;
    EXPECT_FALSE(reader.complete()) << size;
    ASSERT_EQ(reader.problems().size(), 1u) << size;
    EXPECT_NE(reader.problems()[0].find(": was cut off "), std::string::npos) << reader.problems()[0];
  }
}

TEST(Reader, AFlippedBitAnywhereIsNoCrashAndNeverAnotherMessage) {
  const TemporaryFile file("flip");
  {
    Writer writer(file.path());
    write_sample(writer);
  }
  const Bytes whole = file.bytes();
  for (std::size_t at = sizeof kMagic; at < whole.size(); ++at) {
    Bytes damaged = whole;
    damaged[at] = static_cast<std::uint8_t>(damaged[at] ^ (1u << (at % 8)));
    file.set_bytes(damaged);
    Reader reader(file.path());
    while (const ReadMessage* read = reader.next()) {
      const int number = static_cast<int>(read->message.sequence);
      EXPECT_EQ(Bytes(read->message.data.begin(), read->message.data.end()), sample_data(number)) << at;
    }
  }
}

TEST(Reader, ADamagedChunkIsReportedAndTheOthersAreRead) {
  const TemporaryFile file("damaged");
  {
    Writer writer(file.path());
    write_sample(writer);
  }
  Bytes bytes = file.bytes();
  bytes[bytes.size() / 3] ^= 0x40;
  file.set_bytes(bytes);
  Reader reader(file.path());
  int messages = 0;
  while (reader.next() != nullptr) ++messages;
  EXPECT_EQ(messages, kSampleMessages - 10);
  EXPECT_TRUE(reader.complete());
  ASSERT_EQ(reader.problems().size(), 1u);
  EXPECT_NE(reader.problems()[0].find(file.path()), std::string::npos);
}

TEST(Reader, WithoutTheChunkInWhichTheChannelsStandFirstTheLaterOnesAreRead) {
  const TemporaryFile file("channels");
  {
    Writer writer(file.path(), {.compression = Compression::none});
    write_sample(writer);
  }
  ASSERT_NO_FATAL_FAILURE(damage(file, "/second"));
  Reader reader(file.path());
  int messages = 0;
  for (const ReadMessage* read = reader.next(); read != nullptr; read = reader.next(), ++messages) {
    const bool first = read->message.sequence % 2 == 0;
    ASSERT_EQ(read->channel->topic, first ? "/first" : "/second");
    ASSERT_EQ(read->schema != nullptr, first);
  }
  EXPECT_EQ(messages, kSampleMessages - 10);
  EXPECT_TRUE(reader.complete());
  ASSERT_EQ(reader.problems().size(), 1u);
  EXPECT_NE(reader.problems()[0].find("a chunk's check sum is wrong"), std::string::npos);
}

/// Other programs may declare a channel once, in a chunk that is damaged.
TEST(Reader, MessagesOfAnUnknownChannelAreReportedOnceAndLeaveTheOthersOfTheirChunk) {
  const TemporaryFile file("unknown");
  constexpr std::size_t kHead = 9, kBody = 22;  // operation and length; channel, number and times
  Bytes records(4 * (kHead + kBody));
  for (std::uint8_t number = 0; number < 4; ++number) {
    std::uint8_t* message = &records[number * (kHead + kBody)];
    message[0] = static_cast<std::uint8_t>(Op::message);
    message[1] = kBody;
    message[kHead] = number % 2 == 0 ? 2 : 1;  // the channel
    message[kHead + 2] = number;
  }
  file.set_bytes(file_of({{Op::channel, kChannel1}, {Op::chunk, chunk_of(records)}}));
  Reader reader(file.path());
  std::vector<std::uint32_t> numbers;
  while (const ReadMessage* read = reader.next()) numbers.push_back(read->message.sequence);
  EXPECT_EQ(numbers, (std::vector<std::uint32_t>{1, 3}));
  ASSERT_EQ(reader.problems().size(), 1u);
  EXPECT_NE(reader.problems()[0].find("a message of an unknown channel"), std::string::npos);
}

TEST(Reader, ADamagedAttachmentIsReportedAndLeftOut) {
  const TemporaryFile file("attachment");
  {
    Writer writer(file.path());
    write_sample(writer);
  }
  Bytes bytes = file.bytes();
  const Bytes text = {'a', ' ', '=', ' ', '1', '\n'};
  const auto at = std::ranges::search(bytes, text).begin();
  ASSERT_NE(at, bytes.end());
  at[4] ^= 0x02;  // a = 3
  file.set_bytes(bytes);
  Reader reader(file.path());
  EXPECT_EQ(count_messages(reader), kSampleMessages);
  ASSERT_EQ(reader.problems().size(), 1u);
  EXPECT_NE(reader.problems()[0].find("an attachment's check sum is wrong"), std::string::npos);
  ASSERT_EQ(reader.attachments().size(), 1u);
  EXPECT_EQ(reader.attachments()[0].name, "robot.urdf");
  EXPECT_EQ(reader.attachments()[0].log_time_ns, 7);
  EXPECT_EQ(reader.attachments()[0].create_time_ns, 8);
}

/// Other programs may leave out the check sum.
TEST(Reader, ARecordLongerThanItsChunkIsReportedOnceAndEndsTheChunk) {
  const TemporaryFile file("long");
  Bytes records = {static_cast<std::uint8_t>(Op::message), 200, 0, 0, 0, 0, 0, 0, 0};
  const Bytes message = {static_cast<std::uint8_t>(Op::message), 22, 0, 0, 0, 0, 0, 0, 0, 1};  // of channel 1
  records.insert(records.end(), message.begin(), message.end());
  records.resize(records.size() + 21);
  file.set_bytes(file_of({{Op::channel, kChannel1}, {Op::chunk, chunk_of(records)}}));
  Reader reader(file.path());
  EXPECT_EQ(reader.next(), nullptr) << "a message inside of the long record";
  EXPECT_TRUE(reader.complete());
  EXPECT_EQ(reader.problems().size(), 1u);
}

/// Other programs may write such files; nothing here shows whether the message is damaged.
TEST(Reader, AMessageOutsideOfAChunkIsReportedAndLeftOut) {
  const TemporaryFile file("outside");
  file.set_bytes(file_of({{Op::message, Bytes(30)}}));
  Reader reader(file.path());
  EXPECT_EQ(reader.next(), nullptr);
  EXPECT_TRUE(reader.complete());
  ASSERT_EQ(reader.problems().size(), 1u);
  EXPECT_NE(reader.problems()[0].find("a message outside of a chunk"), std::string::npos);
}

TEST(Reader, RefusesWhatIsNoRecordInOneSentence) {
  EXPECT_THROW(Reader("/nowhere/at/all.mcap"), std::runtime_error);
  const TemporaryFile file("other");
  file.set_bytes(Bytes(100, 'x'));
  EXPECT_THROW(Reader(file.path()), std::runtime_error);
  file.set_bytes({});
  EXPECT_THROW(Reader(file.path()), std::runtime_error);
}

}  // namespace
}  // namespace stilt::mcap
