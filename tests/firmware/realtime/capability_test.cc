#include "firmware/realtime/capability.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "firmware/realtime/thread.h"
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
  /// Whether this process has a file of the machine open.
  [[nodiscard]] bool is_open(const std::string& path) const {
    const std::filesystem::path file = std::filesystem::canonical(root_ + path);
    std::error_code gone;
    return std::ranges::any_of(std::filesystem::directory_iterator("/proc/self/fd"), [&](const auto& entry) {
      return std::filesystem::read_symlink(entry, gone) == file;
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
  EXPECT_TRUE(says(acquire({.torque_core = 1}, root_), "governor of processor 1 is powersave"));
  EXPECT_TRUE(says(acquire({.planner_core = 1}, root_), "governor of processor 1 is powersave"));
  write("/sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "performance");
  EXPECT_FALSE(says(acquire({.torque_core = 1}, root_), "governor"));
}

TEST_F(Machine, AProcessorThatIsNotThereIsNamed) {
  EXPECT_TRUE(says(acquire({.torque_core = 1000}, root_), "processor 1000 is not there"));
}

TEST_F(Machine, AProcessorThatThreadsMayTakeIsThereThoughTheProgramStartsWithoutIt) {
  cpu_set_t before;
  ASSERT_EQ(sched_getaffinity(0, sizeof before, &before), 0);
  std::vector<int> cores;
  for (int core = 0; core < CPU_SETSIZE; ++core) {
    if (CPU_ISSET(static_cast<std::size_t>(core), &before)) cores.push_back(core);
  }
  if (cores.size() < 2) GTEST_SKIP() << "one processor";
  ASSERT_TRUE(take_core(cores[0]));  // as isolcpus= leaves init and all that it starts
  const Capability capability = acquire({.torque_core = cores[0], .planner_core = cores[1]}, root_);
  EXPECT_FALSE(says(capability, "processor " + std::to_string(cores[1]) + " is not there"))
      << lacking_text(capability);
  EXPECT_FALSE(says(capability, "share one processor")) << lacking_text(capability);
  EXPECT_EQ(capability.cores, 2);
  cpu_set_t after;
  ASSERT_EQ(sched_getaffinity(0, sizeof after, &after), 0);
  EXPECT_EQ(CPU_COUNT(&after), 1) << "what was tried is put back";
  EXPECT_TRUE(CPU_ISSET(static_cast<std::size_t>(cores[0]), &after));
  EXPECT_TRUE(says(acquire({}, root_), "share one processor"));
  sched_setaffinity(0, sizeof before, &before);
}

TEST_F(Machine, ThrottlingOfRealTimeThreadsBelowTheDefaultIsNamed) {
  const auto throttles = [this](const std::string& runtime_us) {
    write("/proc/sys/kernel/sched_rt_period_us", "1000000");
    write("/proc/sys/kernel/sched_rt_runtime_us", runtime_us);
    return says(acquire({}, root_), "kernel.sched_rt_runtime_us is " + runtime_us + " of 1000000 us");
  };
  EXPECT_FALSE(says(acquire({}, root_), "sched_rt_runtime_us")) << "a kernel without it";
  EXPECT_FALSE(throttles("950000"));
  EXPECT_FALSE(throttles("1000000"));
  EXPECT_FALSE(throttles("-1")) << "never";
  EXPECT_TRUE(throttles("949999"));
  EXPECT_TRUE(throttles("0"));
}

TEST_F(Machine, AProcessorThatTheKernelKeepsFreeIsKnown) {
  EXPECT_FALSE(acquire({.torque_core = 2}, root_).core_isolated);
  write("/sys/devices/system/cpu/isolated", "1-2");
  EXPECT_TRUE(acquire({.torque_core = 2}, root_).core_isolated);
  EXPECT_FALSE(acquire({.torque_core = 3}, root_).core_isolated);
  EXPECT_FALSE(acquire({}, root_).core_isolated) << "set to none";
}

/// Idle state of processor 1.
struct IdleMachine : Machine {
  void state(const std::string& name, const std::string& exit_us) {
    write("/sys/devices/system/cpu/cpu1/cpuidle/state0/name", name);
    write("/sys/devices/system/cpu/cpu1/cpuidle/state0/latency", exit_us);
  }
  const Requirements requirements_{.torque_core = 1, .idle_exit_max_s = 20e-6};
};

TEST_F(IdleMachine, ShortIdleStatesAreAskedForAndHeldAsLongAsTheCapabilityLives) {
  state("C6", "133");
  write("/dev/cpu_dma_latency", "");
  Capability capability = acquire(requirements_, root_);
  EXPECT_TRUE(capability.idle.held());
  EXPECT_FALSE(says(capability, "cpu_dma_latency"));
  std::int32_t asked_us = 0;  // the file has the kernel's format: 32 bits
  std::ifstream(root_ + "/dev/cpu_dma_latency").read(reinterpret_cast<char*>(&asked_us), sizeof asked_us);
  EXPECT_EQ(asked_us, 20);
  EXPECT_TRUE(is_open("/dev/cpu_dma_latency"));
  {
    const Capability taken = std::move(capability);
  }
  EXPECT_FALSE(is_open("/dev/cpu_dma_latency"));
}

TEST_F(IdleMachine, ARequestThatIsNotGrantedLacksWhereIdleStatesAreSlow) {
  state("C6", "133");
  EXPECT_TRUE(says(acquire(requirements_, root_),
                   "a processor takes 133 us to leave idle state C6, and /dev/cpu_dma_latency cannot be held "
                   "(No such file or directory)"));
  state("C1", "20");
  EXPECT_FALSE(says(acquire(requirements_, root_), "cpu_dma_latency"));
}

TEST_F(Machine, WithoutIdleStatesNoRequestIsLacking) {
  const Capability capability = acquire({.torque_core = 1}, root_);
  EXPECT_FALSE(capability.idle.held());
  EXPECT_FALSE(says(capability, "cpu_dma_latency"));
}

TEST_F(Machine, WithoutPriorityItIsNotRealTime) {
  const Capability capability = acquire({.torque_priority = 0}, root_);
  EXPECT_TRUE(says(capability, "no priority"));
  EXPECT_FALSE(capability.realtime());
  EXPECT_NE(lacking_text(capability), "");
}

}  // namespace
}  // namespace stilt::realtime
