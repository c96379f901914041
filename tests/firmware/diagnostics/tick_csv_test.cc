#include "firmware/diagnostics/tick_csv.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "tests/full_disk.h"
#include "tests/own_folder.h"

namespace stilt::diagnostics {
namespace {

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> result(1);
  for (const char c : line) {
    if (c == ',') {
      result.emplace_back();
    } else if (c != '\n') {
      result.back() += c;
    }
  }
  return result;
}

std::vector<std::string> header() {
  std::ostringstream out;
  write_tick_header(out);
  return cells(out.str());
}

std::map<std::string, std::string> written(const control_loop::TickRecord& record, std::int64_t start_ns) {
  std::ostringstream out;
  write_tick(out, record, start_ns);
  const std::vector<std::string> names = header();
  const std::vector<std::string> values = cells(out.str());
  EXPECT_EQ(values.size(), names.size());
  std::map<std::string, std::string> result;
  for (std::size_t i = 0; i < names.size(); ++i) result[names[i]] = values[i];
  return result;
}

TEST(TickCsv, ColumnsHaveNamesOfTheirOwn) {
  const std::vector<std::string> names = header();
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
}

TEST(TickCsv, NumbersThatAreNoEnumeratorsAreUnknown) {
  control_loop::TickRecord record;
  record.action = static_cast<supervisor::Action>(255);
  record.state = static_cast<supervisor::State>(255);
  record.level = static_cast<supervisor::FallbackLevel>(255);
  record.reaction = static_cast<supervisor::Reaction>(255);
  record.joints[0].state = static_cast<hal::DriverState>(255);
  const auto row = written(record, 0);
  for (const char* column : {"action", "state", "fallback_level", "reaction", "hip_L_driver_state"}) {
    EXPECT_EQ(row.at(column), "unknown") << column;
  }
}

TEST(TickCsv, ColumnsBeginWithTheDecisionAndGoOnJointByJoint) {
  const std::vector<std::string> names = header();
  ASSERT_EQ(names.size(), 2u + 12 + 4 * 11 + 8 + 14 + 2 * 4 * 5);
  const std::vector<std::string> first = {
      "tick",         "time_s",           "state", "fallback_level", "reaction",   "action",
      "faults",       "latched_faults",   "ramp",  "plan_sequence",  "plan_age_s", "wakeup_latency_us",
      "execution_us", "bus_round_trip_us"};
  EXPECT_TRUE(std::ranges::equal(std::span(names).first(14), first));
  EXPECT_EQ(names[14 + 11 + 6], "knee_L_missed_replies");
  EXPECT_EQ(names[14 + 4 * 11 + 7], "base_unchanged_replies");
  EXPECT_EQ(names.back(), "sent_knee_R_kd_Nms_rad");
}

TEST(TickCsv, ARecordStandsUnderItsColumns) {
  control_loop::TickRecord record;
  record.tick = 12;
  record.time_ns = 5'250'000'000;
  record.joints[1].position_rad = 0.1;
  record.joints[3].fault = hal::DriverFault::over_current;
  record.joints[3].state = hal::DriverState::fault;
  record.base.pitch_rad = -0.025;
  record.estimated_state[8] = 0.125;
  record.sent[2].torque_Nm = -31.5;
  record.state = supervisor::State::walk;
  record.level = supervisor::FallbackLevel::plan_feedback;
  record.present.add(supervisor::Fault::failed_solves);
  record.present.add(supervisor::Fault::bus_error);
  record.wakeup_latency_ns = 12'345;
  const auto columns = written(record, 5'000'000'000);
  EXPECT_EQ(columns.at("tick"), "12");
  EXPECT_EQ(columns.at("time_s"), "0.25");
  EXPECT_EQ(columns.at("knee_L_position_rad"), "0.1");
  EXPECT_EQ(columns.at("hip_L_position_rad"), "nan");
  EXPECT_EQ(columns.at("knee_R_driver_fault"), "over current");
  EXPECT_EQ(columns.at("knee_R_driver_state"), "fault");
  EXPECT_EQ(columns.at("base_pitch_rad"), "-0.025");
  EXPECT_EQ(columns.at("estimated_z_b_m_s"), "0.125");
  EXPECT_EQ(columns.at("sent_hip_R_torque_Nm"), "-31.5");
  EXPECT_EQ(columns.at("state"), "walk");
  EXPECT_EQ(columns.at("fallback_level"), "plan_feedback");
  EXPECT_EQ(columns.at("faults"), "bus_error+failed_solves");
  EXPECT_EQ(columns.at("latched_faults"), "");
  EXPECT_EQ(columns.at("wakeup_latency_us"), "12.345");
}

TEST(TickCsv, ABlackBoxBecomesAFileWithOneLineATick) {
  const auto box = std::make_unique<control_loop::TickBlackBox>();
  for (std::uint64_t tick = 0; tick < 2500; ++tick) {
    control_loop::TickRecord* record = box->claim();
    ASSERT_NE(record, nullptr);
    *record = {};
    record->tick = tick;
    box->commit(tick == 2499);
  }
  const tests::OwnFolder folder;
  const std::string path = folder.file("box.csv");
  ASSERT_TRUE(write_csv(path, *box, 0));
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(cells(line), header());
  std::uint64_t expected = 500;
  while (std::getline(file, line)) {
    EXPECT_EQ(cells(line)[0], std::to_string(expected));
    ++expected;
  }
  EXPECT_EQ(expected, 2500u);
}

TEST(TickCsv, AFullDiskLeavesTheFileOfTheFaultBefore) {
  const auto box = std::make_unique<control_loop::TickBlackBox>();
  *box->claim() = {};
  box->commit(true);
  const tests::OwnFolder folder;
  const std::string path = folder.file("box.csv");
  std::ofstream(path) << "the fault before";
  {
    const tests::FullDisk full(100);
    EXPECT_FALSE(write_csv(path, *box, 0));
  }
  std::string line;
  std::getline(std::ifstream(path), line);
  EXPECT_EQ(line, "the fault before");
}

TEST(TickCsv, AFileThatCannotBeWrittenIsSaidInOneSentence) {
  const auto box = std::make_unique<control_loop::TickBlackBox>();
  const auto result = write_csv("/nonexistent/folder/box.csv", *box, 0);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error(),
            "/nonexistent/folder/box.csv: the black box cannot be written there (No such file or directory)");
}

}  // namespace
}  // namespace stilt::diagnostics
