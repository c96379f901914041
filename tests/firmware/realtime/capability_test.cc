#include "firmware/realtime/capability.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "tests/own_folder.h"

namespace stilt::realtime {
namespace {

/// A machine's files under a folder of its own.
class Machine : public testing::Test {
 protected:
  void write(const std::string& path, const std::string& text) {
    const std::filesystem::path file = root_ + path;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text << '\n';
  }
  [[nodiscard]] static bool says(const Capability& capability, const std::string& part) {
    return std::ranges::any_of(capability.lacking, [&](const std::string& sentence) {
      return sentence.find(part) != std::string::npos;
    });
  }
  tests::OwnFolder folder_;
  std::string root_ = folder_.path().string();
};

TEST_F(Machine, ARealTimeKernelIsKnownByItsFile) {
  write("/sys/kernel/realtime", "1");
  const Capability capability = acquire({}, root_);
  EXPECT_TRUE(capability.realtime_kernel);
  EXPECT_FALSE(says(capability, "PREEMPT_RT"));
  EXPECT_FALSE(capability.kernel.empty());
}

TEST_F(Machine, AGovernorThatSavesPowerIsNamed) {
  write("/sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "powersave");
  EXPECT_TRUE(says(acquire({.torque_core = 1}, root_), "governor is powersave"));
  write("/sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "performance");
  EXPECT_FALSE(says(acquire({.torque_core = 1}, root_), "governor"));
}

TEST_F(Machine, AProcessorThatIsNotThereIsNamed) {
  EXPECT_TRUE(says(acquire({.torque_core = 1000}, root_), "processor 1000 is not there"));
}

TEST_F(Machine, WithoutPriorityItIsNotRealTime) {
  const Capability capability = acquire({.torque_priority = 0}, root_);
  EXPECT_TRUE(says(capability, "no priority"));
  EXPECT_FALSE(capability.realtime());
  EXPECT_NE(lacking_text(capability), "");
}

}  // namespace
}  // namespace stilt::realtime
