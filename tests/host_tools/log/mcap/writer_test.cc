// Records held against @mcap/core, a reader by other people.
#include "host_tools/log/mcap/writer.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <stdexcept>

#include "host_tools/log/mcap/crc32.h"
#include "tests/host_tools/log/mcap/sample_file.h"
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
  EXPECT_EQ(by_index["statistics"]["messages"], kSampleMessages);
  EXPECT_EQ(by_index["chunks"], kSampleChunks);
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

TEST(Writer, AnEmptyRecordIsWhole) {
  const TemporaryFile file("empty");
  { Writer writer(file.path()); }
  const Json found = run_reader("read_mcap.cjs", {file.path()});
  EXPECT_TRUE(found["messages"].empty());
  EXPECT_TRUE(found["ended"]);
}

TEST(Writer, AFileThatCannotBeMadeIsRefusedByName) {
  try {
    Writer writer("/nowhere/at/all.mcap");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/at/all.mcap"), std::string::npos);
  }
}

TEST(Writer, AFullDiskIsTold) {
  try {
    Writer writer("/dev/full");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("cannot be written"), std::string::npos);
  }
}

}  // namespace
}  // namespace stilt::mcap
