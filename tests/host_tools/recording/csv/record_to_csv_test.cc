#include "host_tools/recording/csv/record_to_csv.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "firmware/diagnostics/tick_csv.h"
#include "host_tools/recording/csv/csv_table.h"
#include "host_tools/recording/record/recorder.h"
#include "tests/full_disk.h"
#include "tests/host_tools/recording/mcap/sample_file.h"
#include "tests/host_tools/recording/record_sample.h"
#include "tests/own_folder.h"

namespace stilt::csv {
namespace {

using record::Recorder;

std::vector<std::string> lines_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

class RecordToCsv : public testing::Test {
 protected:
  RecordToCsv() {
    Recorder recorder(record.path(), {});
    recorder.take(record::ticks_sample(7, 0, 20), 1);
    recorder.take(record::event_sample(7, "it said \"stop\", then went on"), 123);
    recorder.take(record::ticks_sample(7, 10, 20), 2);  // ten of them again
    recorder.take(record::ticks_sample(8, 0, 5), 3);
  }

  mcap::TemporaryFile record{"csv"};
  tests::OwnFolder own;
  std::filesystem::path folder = own.path() / "tables";
};

TEST_F(RecordToCsv, TicksAreRowsAsInABlackBox) {
  const Written written = record_to_csv(record.path(), folder.string());
  EXPECT_TRUE(written.problems.empty());
  for (const auto& [file, ticks] : {std::pair{"ticks.csv", 30u}, {"ticks_2.csv", 5u}}) {  // a run each
    std::ostringstream expected;
    diagnostics::write_tick_header(expected);
    for (std::uint64_t tick = 0; tick < ticks; ++tick) {
      diagnostics::write_tick(expected, record::sample_tick(tick), record::sample_tick(0).time_ns);
    }
    std::ifstream in(folder / file);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), expected.str()) << file;
  }
}

TEST_F(RecordToCsv, TimesOfARecordThatBeganLateCountFromTickZero) {
  const std::int64_t start_ns = record::sample_tick(0).time_ns;
  record.set_bytes({});
  {
    Recorder recorder(record.path(), {});
    recorder.take(record::ticks_sample(7, 2600, 20), 1);
    recorder.take(record::configuration_sample(7, "", telemetry::kWireVersion, "amber3m", start_ns), 2);
    recorder.take(record::ticks_sample(8, 300, 20), 3);  // without configuration
  }
  static_cast<void>(record_to_csv(record.path(), folder.string()));
  EXPECT_EQ(lines_of(folder / "ticks.csv").at(1).find("2600,2.6,"), 0u);
  EXPECT_EQ(lines_of(folder / "ticks_2.csv").at(1).find("300,0,"), 0u);
  const std::string file = own.file("ticks.csv");
  static_cast<void>(ticks_to_csv(record.path(), file));
  EXPECT_EQ(lines_of(file).at(1).find("2600,2.6,"), 0u);
}

TEST_F(RecordToCsv, MissingTicksAreNamedAndTheOthersWritten) {
  record.set_bytes({});
  {
    Recorder recorder(record.path(), {});
    recorder.take(record::ticks_sample(7, 100, 20), 1);
    recorder.take(record::ticks_sample(7, 200, 20), 2);
    recorder.take(record::ticks_sample(8, 0, 5), 3);
    recorder.take(record::ticks_sample(8, 6, 5), 4);
  }
  const std::string first = record.path() + ": ticks 100 to 219, missing: 120 to 199; no rows for them in ";
  const std::string second = record.path() + ": ticks 0 to 10, missing: 5; no rows for them in ";
  const std::string file = own.file("all.csv");
  EXPECT_EQ(ticks_to_csv(record.path(), file).problems,
            (std::vector<std::string>{first + "all.csv", second + "all.csv"}));
  EXPECT_EQ(lines_of(file).size(), 51u);
  EXPECT_EQ(record_to_csv(record.path(), folder.string()).problems,
            (std::vector<std::string>{first + "ticks.csv", second + "ticks_2.csv"}));
  EXPECT_EQ(lines_of(folder / "ticks.csv").size(), 41u);
}

TEST_F(RecordToCsv, AFolderWithTablesIsRefusedAndStaysAsItIs) {
  std::filesystem::create_directory(folder);
  std::ofstream(folder / "notes.txt") << "walked well";
  EXPECT_NO_THROW(static_cast<void>(record_to_csv(record.path(), folder.string())));
  std::ofstream(folder / "ticks_2.csv") << "of another record";
  try {
    static_cast<void>(record_to_csv(record.path(), folder.string()));
    ADD_FAILURE() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()).find(folder.string() + ": has tables already, such as "), 0u);
  }
  EXPECT_EQ(lines_of(folder / "ticks_2.csv"), std::vector<std::string>{"of another record"});
}

TEST_F(RecordToCsv, OtherTopicsAreTablesWithTheFieldsOfTheirMessages) {
  static_cast<void>(record_to_csv(record.path(), folder.string()));
  const std::vector<std::string> lines = lines_of(folder / "stilt_event.csv");
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].find("log_time_ns,run_id,number,"), 0u) << lines[0];
  EXPECT_EQ(lines[1].find("123,7,0,0,0.1,"), 0u) << lines[1];
  EXPECT_NE(lines[1].find(R"("it said ""stop"", then went on")"), std::string::npos) << lines[1];
}

TEST_F(RecordToCsv, AFileTakesTheTicksOfAllRuns) {
  const std::string file = folder.string() + ".csv";
  static_cast<void>(ticks_to_csv(record.path(), file));
  EXPECT_EQ(lines_of(file).size(), 36u);
  std::filesystem::remove(file);
}

TEST_F(RecordToCsv, ARecordThatWasCutOffIsWrittenAsFarAsItGoesAndThatIsReported) {
  mcap::Bytes bytes = record.bytes();
  bytes.erase(bytes.end() - 100, bytes.end());
  record.set_bytes(bytes);
  const Written written = record_to_csv(record.path(), folder.string());
  EXPECT_EQ(written.problems.size(), 1u);
  EXPECT_EQ(lines_of(folder / "ticks.csv").size(), 31u);
}

TEST_F(RecordToCsv, TopicsThatCannotBeDecodedAreNamedAndTheOthersWritten) {
  record.set_bytes({});
  {
    mcap::Writer writer(record.path());
    const auto add = [&](const std::string& topic, const std::string& definition, const std::string& encoding,
                         const mcap::Bytes& data) {
      const std::uint16_t schema =
          writer.add_schema("a" + topic.substr(0, 1) + "msg/T" + topic.substr(1), "ros2msg", definition);
      const std::uint16_t channel = writer.add_channel(schema, topic, encoding);
      writer.write({channel, 0, 0, 0, data});
      writer.write({channel, 1, 1, 1, data});
    };
    const mcap::Bytes data = {0, 1, 0, 0, 5, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    add("/inside", "Tinside x\n", "cdr", data);
    add("/missing", "c/D x\n", "cdr", data);
    add("/array", "int32[N] x\n", "cdr", data);
    add("/json", "int32 x\n", "json", {'{', '}'});
    add("/short", "int64[9] x\n", "cdr", data);
    add("/whole", "int32 x\n", "cdr", data);
    const std::uint16_t none = writer.add_channel(0, "/none", "cdr");
    writer.write({none, 0, 0, 0, data});
    writer.close();
  }
  const Written written = record_to_csv(record.path(), folder.string());
  EXPECT_EQ(lines_of(folder / "whole.csv"), (std::vector<std::string>{"log_time_ns,x", "0,5", "1,5"}));
  EXPECT_FALSE(std::filesystem::exists(folder / "json.csv"));
  const std::vector<std::string> expected = {
      "/array: the field x has the type int32[N], whose number of values is none; it is left out",
      "/inside: the message a/msg/Tinside contains itself; it is left out",
      "/json: its messages are json defined by ros2msg, where cdr defined by ros2msg can be read; it is left "
      "out",
      "/missing: the field x of a/msg/Tmissing has the type c/msg/D, which is not defined; it is left out",
      "/none: the type of its messages is not defined; it is left out",
      "/short: a message ends too early; it is left out"};
  ASSERT_EQ(written.problems.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(written.problems[i], record.path() + ": topic " + expected[i]);
  }
}

TEST_F(RecordToCsv, ARecordWithoutTicksIsRefusedAndLeavesTheFileAsItIs) {
  record.set_bytes({});
  {
    Recorder recorder(record.path(), {});
    recorder.take(record::event_sample(7, "none"), 1);
  }
  const std::string file = own.file("ticks.csv");
  std::ofstream(file) << "of another record";
  try {
    static_cast<void>(ticks_to_csv(record.path(), file));
    ADD_FAILURE() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(), record.path() + ": holds no ticks of stiltd; name a record of stilt record");
  }
  EXPECT_EQ(lines_of(file), std::vector<std::string>{"of another record"});
}

TEST_F(RecordToCsv, AFullDiskLeavesTheEarlierTableAndNoPartOfANewOne) {
  const std::string file = own.file("ticks.csv");
  std::ofstream(file) << "of another record";
  {
    const tests::FullDisk full(1000);
    EXPECT_THROW(static_cast<void>(ticks_to_csv(record.path(), file)), std::runtime_error);
    EXPECT_THROW(static_cast<void>(record_to_csv(record.path(), folder.string())), std::runtime_error);
  }
  EXPECT_EQ(lines_of(file), std::vector<std::string>{"of another record"});
  EXPECT_TRUE(std::filesystem::is_empty(folder));
  const std::filesystem::directory_iterator entries(own.path());
  EXPECT_EQ(std::distance(begin(entries), end(entries)), 2) << "the earlier table and the folder";
  EXPECT_NO_THROW(static_cast<void>(record_to_csv(record.path(), folder.string()))) << "a second trial";
}

TEST_F(RecordToCsv, ATableReplacesAnotherOnceItIsWholeAndALinkStays) {
  const std::string file = own.file("table.csv"), link = own.file("link.csv");
  std::ofstream(file) << "earlier";
  std::filesystem::create_symlink("table.csv", link);
  {
    Table table(link);
    table.add({{"a", 1}});
    table.close();
    EXPECT_EQ(lines_of(file), std::vector<std::string>{"earlier"});
    table.place();
  }
  EXPECT_EQ(lines_of(file), (std::vector<std::string>{"a", "1"}));
  EXPECT_TRUE(std::filesystem::is_symlink(link));
}

TEST_F(RecordToCsv, RefusesPlacesThatCannotBeWritten) {
  EXPECT_THROW(static_cast<void>(record_to_csv(record.path(), "/proc/nowhere")), std::runtime_error);
  EXPECT_THROW(static_cast<void>(ticks_to_csv(record.path(), "/nowhere/ticks.csv")), std::runtime_error);
}

TEST_F(RecordToCsv, ARecordOfRelease01IsRefusedAndLeavesNoFile) {
  record.set_bytes({});
  record::write_record_of_0_1(record.path());
  EXPECT_THROW(static_cast<void>(record_to_csv(record.path(), folder.string())), std::runtime_error);
  EXPECT_FALSE(std::filesystem::exists(folder));
  EXPECT_THROW(static_cast<void>(ticks_to_csv(record.path(), folder.string() + ".csv")), std::runtime_error);
  EXPECT_FALSE(std::filesystem::exists(folder.string() + ".csv"));
}

TEST(Table, CellsAreReadBackTheSame) {
  const mcap::TemporaryFile file("table");
  {
    Table table(file.path());
    table.add(
        {{"a", {{"b", 0.1}, {"c", "x,y"}}}, {"n", std::numeric_limits<double>::quiet_NaN()}, {"l", {1, 2}}});
    table.add({{"a", {{"b", 1e-300}, {"c", ""}}}, {"n", 3}, {"l", nlohmann::ordered_json::array()}});
    table.close();
    table.place();
  }
  const std::vector<std::string> lines = lines_of(file.path());
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0], "a.b,a.c,n,l");
  EXPECT_EQ(lines[1], "0.1,\"x,y\",nan,\"[1,2]\"");
  EXPECT_EQ(lines[2], "1e-300,,3,[]");
}

}  // namespace
}  // namespace stilt::csv
