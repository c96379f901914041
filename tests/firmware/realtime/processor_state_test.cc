#include "firmware/realtime/processor_state.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/own_folder.h"

namespace stilt::realtime {
namespace {

class ProcessorState : public testing::Test {
 protected:
  void write(const std::string& path, const std::string& text) {
    const std::filesystem::path file = root_ + "/sys/devices/system/cpu/" + path;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text << '\n';
  }
  void idle_state(const std::string& state, const std::string& name, int exit_us, int disabled) {
    write("cpu3/cpuidle/" + state + "/name", name);
    write("cpu3/cpuidle/" + state + "/latency", std::to_string(exit_us));
    write("cpu3/cpuidle/" + state + "/disable", std::to_string(disabled));
  }
  tests::OwnFolder folder_;
  std::string root_ = folder_.path().string();
};

TEST_F(ProcessorState, TheDeepestIdleStateIsTheSlowestThatIsNotDisabled) {
  EXPECT_FALSE(deepest_idle_state(3, root_));
  idle_state("state0", "POLL", 0, 0);
  idle_state("state1", "C1", 2, 0);
  idle_state("state2", "C6", 133, 0);
  idle_state("state3", "C10", 890, 1);
  EXPECT_EQ(deepest_idle_state(3, root_)->name, "C6");
  EXPECT_EQ(deepest_idle_state(3, root_)->exit_us, 133.0);
  idle_state("state2", "C6", 133, 1);
  EXPECT_EQ(deepest_idle_state(3, root_)->name, "C1");
  EXPECT_FALSE(deepest_idle_state(-1, root_)) << "processor 0 says nothing";
}

TEST_F(ProcessorState, ThrottlingIsSummedOverProcessors) {
  EXPECT_FALSE(thermal_throttle_count(root_));
  write("cpu0/thermal_throttle/core_throttle_count", "2");
  write("cpu0/thermal_throttle/package_throttle_count", "30");
  write("cpu3/thermal_throttle/core_throttle_count", "5");
  write("online", "0-3");
  EXPECT_EQ(thermal_throttle_count(root_), 37);
}

TEST_F(ProcessorState, InterruptThreadsHavePriorityAndProcessors) {
  const auto process = [&](const std::string& number, const std::string& name, const std::string& stat) {
    const std::filesystem::path folder = root_ + "/proc/" + number;
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "comm") << name << '\n';
    std::ofstream(folder / "stat") << stat << '\n';
    std::ofstream(folder / "status") << "Name:\t" << name << "\nCpus_allowed:\t3\nCpus_allowed_list:\t0-1\n";
  };
  // Field 40 is the priority, by proc(5).
  process(
      "117", "irq/45-can0",
      "117 (irq/45-can0) S 2 0 0 0 -1 2129984 0 0 0 0 0 3 0 0 -51 0 1 0 260 0 0 18446744073709551615 0 0 0 "
      "0 0 0 0 2147483647 0 1 0 0 17 0 50 1 0 0 0 0 0 0 0 0 0 0 0");
  process("118", "irq/46 a) b", "118 (irq/46 a) b) S 2 0 0");
  process("200", "stiltd", "200 (stiltd) S 1 0 0");
  const std::vector<InterruptThread> threads = interrupt_threads(root_);
  ASSERT_EQ(threads.size(), 2u);
  EXPECT_EQ(threads[0].name, "irq/45-can0");
  EXPECT_EQ(threads[0].process, 117);
  EXPECT_EQ(threads[0].priority, 50);
  EXPECT_EQ(threads[0].processors, "0-1");
}

TEST(Processors, AListHoldsItsRanges) {
  EXPECT_TRUE(has_processor("0-3,5", 3));
  EXPECT_TRUE(has_processor("0-3,5", 5));
  EXPECT_FALSE(has_processor("0-3,5", 4));
  EXPECT_TRUE(has_processor("7", 7));
  EXPECT_FALSE(has_processor("", 0));
  EXPECT_TRUE(has_processor("", -1)) << "any";
}

}  // namespace
}  // namespace stilt::realtime
