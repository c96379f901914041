#include "firmware/program/interrupt_report.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/own_folder.h"

namespace stilt::program {
namespace {

using realtime::BusInterrupts;

const std::vector<BusInterrupts> kBuses = {
    {"can0", "spi0.0", {{"irq/45-spi0.0", 117, 50, "0-3"}}},
    {"can1", "usb 1-2:1.0", {{"irq/128-xhci_hc", 90, 50, "0"}, {"ksoftirqd/0", 12, 0, "0"}}},
    {"can2", "usb 1-3:1.0", {{"irq/128-xhci_hc", 90, 50, "0"}}},
    {"can3", "spi0.1", {}},
    {"vcan0", "", {}},
};

TEST(InterruptReport, EachAdapterIsNamedWithItsThreadsOrThatNoneIsKnown) {
  const std::vector<std::string> sentences = interrupt_sentences(kBuses);
  ASSERT_EQ(sentences.size(), 4u) << "none of a bus without hardware";
  EXPECT_EQ(sentences[0], "can0 (spi0.0): irq/45-spi0.0 (process 117, priority 50)");
  EXPECT_NE(sentences[1].find("ksoftirqd/0 (process 12, priority 0)"), std::string::npos);
  EXPECT_EQ(sentences[3],
            "can3 (spi0.1): no interrupt thread is known; with PREEMPT_RT see /proc/interrupts");
}

TEST(InterruptReport, AThreadThatWaitsForThePlannerIsFoundOnce) {
  configuration::RuntimeParameters runtime;
  const auto delayed = delayed_threads(kBuses, runtime);
  ASSERT_EQ(delayed.size(), 2u);
  EXPECT_EQ(delayed[0].process, 117);
  EXPECT_EQ(delayed[1].process, 90);
  runtime.planner_core = 2;
  EXPECT_EQ(delayed_threads(kBuses, runtime).size(), 1u) << "the other cannot run there";
  runtime.planner_core = 0;
  runtime.planner_priority = 49;
  EXPECT_TRUE(delayed_threads(kBuses, runtime).empty());
}

TEST(InterruptReport, AThreadThatWaitsForThePlannerIsNamedWithTheCommandThatMendsIt) {
  const std::vector<std::string> sentences = delay_sentences(kBuses, {});
  ASSERT_EQ(sentences.size(), 2u);
  EXPECT_EQ(
      sentences[0],
      "irq/45-spi0.0 (process 117, priority 50) waits for the planner; as root, chrt -f -p 70 117 puts it "
      "before");
}

TEST(InterruptReport, AThreadThatANewInterfaceHasIsNamedAfterTheReset) {
  namespace fs = std::filesystem;
  const tests::OwnFolder folder;
  const std::string root = folder.path().string();
  fs::create_directories(root + "/sys/devices/fec.can");
  fs::create_directories(root + "/sys/class/net/can0");
  fs::create_directory_symlink(root + "/sys/devices/fec.can", root + "/sys/class/net/can0/device");
  const auto thread = [&](const std::string& process) {
    fs::create_directories(root + "/proc/" + process);
    std::ofstream(root + "/proc/" + process + "/comm") << "irq/11-can0\n";
    std::ofstream(root + "/proc/" + process + "/status") << "Cpus_allowed_list:\t0-1\n";
  };
  using supervisor::State;
  InterruptWatch watch({"can0"}, {}, root);
  thread("141");
  for (const State state : {State::boot, State::idle, State::stand, State::fault, State::fault}) {
    EXPECT_TRUE(watch.update(state).empty()) << name(state);
  }
  fs::remove_all(root + "/proc/141");  // the interface goes down and up
  thread("412");
  const std::vector<std::string> sentences = watch.update(State::idle);
  ASSERT_EQ(sentences.size(), 1u);
  EXPECT_TRUE(sentences[0].starts_with("irq/11-can0 (process 412, priority 0) waits")) << sentences[0];
  EXPECT_TRUE(watch.update(State::idle).empty()) << "once";
  EXPECT_TRUE(watch.update(State::fault).empty());
  EXPECT_TRUE(watch.update(State::off).empty()) << "the end";
}

}  // namespace
}  // namespace stilt::program
