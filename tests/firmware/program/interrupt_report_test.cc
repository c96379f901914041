#include "firmware/program/interrupt_report.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace stilt::program
