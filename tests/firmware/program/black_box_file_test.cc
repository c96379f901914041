#include "firmware/program/black_box_file.h"

#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/full_disk.h"
#include "tests/own_folder.h"

namespace {

int syncs = 0;  ///< calls of fsync in this program

}  // namespace

/// In place of the C library's.
extern "C" int fsync(int descriptor) {
  ++syncs;
  return static_cast<int>(syscall(SYS_fsync, descriptor));
}

namespace stilt::program {
namespace {

using supervisor::Reaction;

class BlackBoxFileTest : public testing::Test {
 protected:
  BlackBoxFileTest() {
    options_.black_box_file = folder_.file("box.csv");
    begin_run();
  }
  void begin_run() { file_.emplace(options_, *state_); }

  /// False: the black box is frozen.
  bool record(std::uint64_t tick, Reaction reaction, bool trigger) {
    control_loop::TickRecord* record = state_->mail.black_box.claim();
    if (record == nullptr) return false;
    *record = {};
    record->tick = tick;
    record->reaction = reaction;
    state_->mail.black_box.commit(trigger);
    return true;
  }

  /// A fault with this reaction in this tick; the black box freezes, and is saved.
  void happen(std::uint64_t tick, Reaction reaction) {
    for (bool trigger = true; record(tick, reaction, trigger); trigger = false) {
    }
    file_->save();
  }

  /// The ticks in a file.
  [[nodiscard]] std::vector<long long> ticks(const std::string& name) const {
    std::ifstream lines(folder_.file(name));
    std::vector<long long> numbers;
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) numbers.push_back(std::stoll(line));
    return numbers;
  }

  /// The tick of the fault that a file holds; -1: it holds none.
  [[nodiscard]] long long kept(const std::string& name = "box.csv") const {
    const std::vector<long long> all = ticks(name);
    return all.empty() ? -1 : all.back();
  }

  tests::OwnFolder folder_;
  Options options_;
  std::unique_ptr<ControllerState> state_ = std::make_unique<ControllerState>();
  std::optional<BlackBoxFile> file_;
};

TEST_F(BlackBoxFileTest, KeepsTheFirstOfEqualFaultsUntilAHarderOneComes) {
  happen(10, Reaction::hold);
  happen(20, Reaction::hold);
  EXPECT_EQ(kept(), 10);
  happen(30, Reaction::damp);
  EXPECT_EQ(kept(), 30);
  happen(40, Reaction::damp);
  happen(50, Reaction::sit);
  EXPECT_EQ(kept(), 30);
  EXPECT_TRUE(file_->finish());
}

/// The robot has fallen, and somebody pulls the battery.
TEST_F(BlackBoxFileTest, TheEndWaitsForTheDiskAndAFaultDoesNot) {
  const int before = syncs;
  happen(10, Reaction::damp);
  EXPECT_EQ(syncs, before);
  EXPECT_TRUE(file_->finish());
  EXPECT_EQ(syncs, before + 1);
}

TEST_F(BlackBoxFileTest, AFaultSoonAfterAnotherHasMoreThanASecondBeforeIt) {
  for (std::uint64_t tick = 1; tick <= 1500; ++tick) record(tick, Reaction::none, false);
  happen(2000, Reaction::hold);
  for (std::uint64_t tick = 3001; tick <= 3100; ++tick) record(tick, Reaction::none, false);
  happen(4000, Reaction::damp);
  const std::vector<long long> all = ticks("box.csv");
  const auto before = std::ranges::count_if(all, [](long long tick) { return tick < 4000; });
  EXPECT_EQ(kept(), 4000);
  EXPECT_GT(before, 1000);
  EXPECT_TRUE(std::ranges::is_sorted(all));
}

TEST_F(BlackBoxFileTest, OnAFullDiskKeepsTheFaultBeforeAndSaysThatTheHarderOneIsLost) {
  happen(10, Reaction::hold);
  {
    const tests::FullDisk full(1000);
    happen(20, Reaction::damp);
  }
  EXPECT_EQ(kept(), 10);
  happen(30, Reaction::sit);
  EXPECT_EQ(kept(), 30) << "harder than what the file held";
  const auto saved = file_->finish();
  ASSERT_FALSE(saved);
  EXPECT_NE(saved.error().find("--black-box " + options_.black_box_file), std::string::npos) << saved.error();
  happen(40, Reaction::damp);
  EXPECT_EQ(kept(), 40);
  EXPECT_TRUE(file_->finish()) << "a fault as hard as the lost one is there";
}

TEST_F(BlackBoxFileTest, ALaterRunKeepsTheFilesOfEarlierOnes) {
  happen(10, Reaction::damp);
  begin_run();
  EXPECT_TRUE(file_->finish());
  EXPECT_EQ(kept(), 10) << "a run without a fault";
  begin_run();
  happen(20, Reaction::warn);
  happen(21, Reaction::hold);
  EXPECT_EQ(kept(), 21);
  EXPECT_EQ(kept("box.1.csv"), 10) << "the fall";
  begin_run();
  happen(30, Reaction::warn);
  EXPECT_EQ(kept(), 30);
  EXPECT_EQ(kept("box.1.csv"), 21);
  EXPECT_EQ(kept("box.2.csv"), 10);
  EXPECT_EQ(kept("box.3.csv"), -1);
}

}  // namespace
}  // namespace stilt::program
