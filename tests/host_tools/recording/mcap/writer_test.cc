// Records held against @mcap/core, a reader by other people.
#include "host_tools/recording/mcap/writer.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <stdexcept>
#include <vector>

#include "host_tools/recording/mcap/crc32.h"
#include "tests/host_tools/recording/mcap/sample_file.h"
#include "tests/independent_readers/run_reader.h"

namespace stilt::mcap {
namespace {

using independent_readers::run_reader;
using Json = nlohmann::json;

void expect_sample(const Json& found, int messages) {
  ASSERT_EQ(found.at("messages").size(), static_cast<std::size_t>(messages));
  for (int i = 0; i < messages; ++i) {
    const Json& message = found["messages"][static_cast<std::size_t>(i)];
    EXPECT_EQ(message["sequence"], i);
    EXPECT_EQ(message["log_time_ns"], std::to_string(1'000'000 + i * 100));
    EXPECT_EQ(message["publish_time_ns"], std::to_string(900'000 + i));
    EXPECT_EQ(message["channel"], i % 2);
    EXPECT_EQ(message["crc"], crc32(sample_data(i))) << i;
  }
  ASSERT_EQ(found["channels"].size(), 2u);
  const Json& channel = found["channels"][0];
  EXPECT_EQ(channel["topic"], "/first");
  EXPECT_EQ(channel["encoding"], "cdr");
  EXPECT_EQ(channel["metadata"]["frame"], "world");
  EXPECT_EQ(channel["schema"], "pkg/msg/Number");
  EXPECT_EQ(channel["schema_encoding"], "ros2msg");
  EXPECT_EQ(channel["schema_text"], "float64 value\n");
}

class ACompression : public testing::TestWithParam<Compression> {};

TEST_P(ACompression, IsReadByOthersFromFrontAndByIndex) {
  const TemporaryFile file("writer");
  {
    Writer writer(file.path(), {.compression = GetParam()});
    write_sample(writer);
    writer.close();
  }
  const Json by_index = run_reader("read_mcap.cjs", {file.path(), "index"});
  expect_sample(by_index, kSampleMessages);
  EXPECT_EQ(by_index["chunks"], kSampleChunks);
  EXPECT_EQ(by_index["statistics"], Json::parse(R"({
    "messages": 90, "schemas": 1, "channels": 2, "attachments": 2, "metadata": 1, "chunks": 9,
    "times_ns": [1000000, 1008900], "messages_of_channel": [[0, 45], [1, 45]]})"));
  const Json from_front = run_reader("read_mcap.cjs", {file.path()});
  expect_sample(from_front, kSampleMessages);
  EXPECT_TRUE(from_front["ended"]);
  for (const Json& found : {by_index, from_front}) {
    ASSERT_EQ(found["attachments"].size(), 2u);
    EXPECT_EQ(found["attachments"][0]["text"], "a = 1\n");
    EXPECT_EQ(found["attachments"][1]["media_type"], "application/xml");
    EXPECT_EQ(found["metadata"][0][1]["number"], "17");
  }
}

INSTANTIATE_TEST_SUITE_P(Writer, ACompression,
                         testing::Values(Compression::none, Compression::lz4, Compression::zstd));

TEST(Writer, AFileNeverClosedIsReadByOthersUpToTheLastFlush) {
  const TemporaryFile file("unclosed");
  {
    Writer writer(file.path());
    write_sample(writer);
    const Bytes so_far = file.bytes();
    writer.close();
    file.set_bytes(so_far);
  }
  const Json found = run_reader("read_mcap.cjs", {file.path()});
  expect_sample(found, kSampleMessages);
  EXPECT_FALSE(found["ended"]);
}

TEST(Writer, TimesOutOfOrderGiveChunksAndStatisticsTheirEarliestAndLatest) {
  const TemporaryFile file("order");
  {
    Writer writer(file.path());
    const std::uint16_t channel = writer.add_channel(0, "/first", "json");
    std::uint32_t sequence = 0;
    for (const auto& chunk : {std::vector<std::int64_t>{50, 70, 40, 60}, {30, 90, 80}, {55}}) {
      for (const std::int64_t time_ns : chunk) writer.write({channel, sequence++, time_ns, 0, {}});
      writer.flush();
    }
  }
  const Json found = run_reader("read_mcap.cjs", {file.path(), "index"});
  EXPECT_EQ(found["chunk_times_ns"], Json::parse("[[40, 70], [30, 90], [55, 55]]"));
  EXPECT_EQ(found["statistics"]["times_ns"], Json::parse("[30, 90]"));
  EXPECT_EQ(found["messages"].size(), 8u);
}

/// The op codes of the groups in the summary. Each begins with a record of its kind, where the one before
/// ends.
std::vector<int> groups_of(const Json& found, const Bytes& bytes) {
  std::vector<int> ops;
  std::size_t end = 0;
  for (const Json& group : found["groups"]) {
    const auto start = group["start"].get<std::size_t>();
    const auto length = group["length"].get<std::size_t>();
    EXPECT_GT(length, 0u) << group;
    EXPECT_EQ(bytes.at(start), group["op"]) << group;
    EXPECT_TRUE(end == 0 || start == end) << group;
    end = start + length;
    ops.push_back(group["op"]);
  }
  return ops;
}

TEST(Writer, TheSummaryListsTheGroupsThatItHas) {
  const TemporaryFile file("groups");
  {
    Writer writer(file.path());
    write_sample(writer);
  }
  const std::vector<int> all{0x03, 0x04, 0x0B, 0x08, 0x0A, 0x0D};
  EXPECT_EQ(groups_of(run_reader("read_mcap.cjs", {file.path()}), file.bytes()), all);
}

/// @mcap/core does not look at it; the specification has it cover all before the record that holds it.
TEST(Writer, TheSumOfTheDataCoversTheFileUpToItsRecord) {
  const TemporaryFile file("sum");
  {
    Writer writer(file.path());
    write_sample(writer);
  }
  const Json found = run_reader("read_mcap.cjs", {file.path()});
  const Bytes bytes = file.bytes();
  const auto end = found["groups"][0]["start"].get<std::size_t>();  // of the data
  const std::size_t record = end - kRecordHead_bytes - 4;
  ASSERT_EQ(bytes.at(record), static_cast<std::uint8_t>(Op::data_end));
  EXPECT_EQ(ByteReader(ByteView(bytes).subspan(end - 4)).take<std::uint32_t>(),
            crc32(ByteView(bytes).first(record)));
}

TEST(Writer, AnEmptyRecordIsWholeAndItsSummaryHasStatisticsAlone) {
  const TemporaryFile file("empty");
  {
    Writer writer(file.path());
  }
  const Json found = run_reader("read_mcap.cjs", {file.path()});
  EXPECT_TRUE(found["messages"].empty());
  EXPECT_TRUE(found["ended"]);
  EXPECT_EQ(groups_of(found, file.bytes()), std::vector<int>{0x0B});
}

TEST(Writer, AChunkIsWrittenWhenItHasGrownToItsSize) {
  const TemporaryFile file("grown");
  Writer writer(file.path(), {.compression = Compression::none, .chunk_bytes = 1000});
  const std::uint16_t channel = writer.add_channel(0, "/first", "json");
  const Bytes data(400, 7);
  writer.write({channel, 0, 1, 1, data});
  writer.write({channel, 1, 2, 2, data});
  EXPECT_EQ(writer.statistics().chunks, 0u);
  writer.write({channel, 2, 3, 3, data});
  EXPECT_EQ(writer.statistics().chunks, 1u);
  EXPECT_EQ(file.bytes().size(), writer.bytes_written());
}

TEST(Writer, RefusesMessagesOfNoChannelAndChannelsOfNoSchema) {
  const TemporaryFile file("unknown");
  Writer writer(file.path());
  EXPECT_THROW(writer.add_channel(1, "/first", "cdr"), std::runtime_error);
  EXPECT_THROW(writer.write({0, 0, 0, 0, {}}), std::runtime_error);
}

TEST(Writer, AFileThatCannotBeMadeIsRefusedByName) {
  try {
    Writer writer("/nowhere/at/all.mcap");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/at/all.mcap"), std::string::npos);
  }
}

std::string refusal_of(const std::string& path) {
  try {
    const Writer writer(path);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(Writer, AnEarlierRecordIsRefusedAndStaysAsItIs) {
  const TemporaryFile file("earlier");
  const std::string exists = file.path() + ": exists; name another file or remove it";
  file.set_bytes({});
  EXPECT_EQ(refusal_of(file.path()), "") << "an empty file is no record";
  const Bytes earlier = file.bytes();
  EXPECT_FALSE(earlier.empty());
  EXPECT_EQ(refusal_of(file.path()), exists);
  EXPECT_EQ(file.bytes(), earlier);
  EXPECT_THROW(OutputFile::require_new(file.path()), std::runtime_error);
}

TEST(Writer, AFileHasOneWriter) {
  const TemporaryFile file("shared");
  const OutputFile first(file.path());
  EXPECT_NO_THROW(OutputFile::require_new(file.path())) << "it has no content yet";
  EXPECT_EQ(refusal_of(file.path()), file.path() + ": exists; name another file or remove it");
  EXPECT_TRUE(file.bytes().empty());
}

TEST(Writer, ADeviceIsWrittenToAsItIs) {
  const OutputFile first("/dev/null"), second("/dev/null");
  EXPECT_NO_THROW(OutputFile::require_new("/dev/null"));
}

TEST(Writer, AFullDiskIsReported) {
  try {
    Writer writer("/dev/full");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(
        std::string(error.what()),
        "/dev/full: cannot be written any further (No space left on device); make room, or name a file on "
        "another disk");
  }
}

}  // namespace
}  // namespace stilt::mcap
