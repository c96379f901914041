#include "firmware/program/interrupt_priorities.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace stilt::program {
namespace {

using realtime::BusInterrupts;

/// What the kernel was asked for.
struct Kernel {
  std::vector<std::pair<int, int>> set;
  std::string refusal;

  SetPriority answer() {
    return [this](int process, int priority) {
      set.emplace_back(process, priority);
      return refusal;
    };
  }
};

const std::vector<BusInterrupts> kBuses = {
    {"can0", "0000:03:00.0", {{"irq/45-peak_pciefd", 117, 50, "0-3"}, {"napi/can0-8", 118, 75, "0-3"}}},
    {"can1", "usb 1-2:1.0", {{"irq/128-xhci_hc", 90, 60, "0"}, {"ksoftirqd/0", 12, 0, "0"}}},
    {"can2", "spi0.1", {}},
};

TEST(InterruptPriorities, ThreadsThatWaitForThePlannerComeBetweenItAndTheTorqueLoop) {
  Kernel kernel;
  const auto text = raise_interrupts(kBuses, {}, kernel.answer());
  ASSERT_TRUE(text) << text.error();
  EXPECT_EQ(kernel.set, (std::vector<std::pair<int, int>>{{117, 70}, {90, 70}}));
  EXPECT_EQ(*text,
            "can0: irq/45-peak_pciefd (process 117, priority 50) has 70 now\n"
            "can0: napi/can0-8 (process 118, priority 75) stays\n"
            "can1: irq/128-xhci_hc (process 90, priority 60) has 70 now\n"
            "can2: no interrupt thread is known; with PREEMPT_RT see /proc/interrupts\n");
}

TEST(InterruptPriorities, AreThoseOfTheConfiguration) {
  configuration::RuntimeParameters runtime;
  runtime.planner_priority = 30;
  runtime.torque_priority = 40;
  Kernel kernel;
  ASSERT_TRUE(raise_interrupts(kBuses, runtime, kernel.answer()));
  EXPECT_TRUE(kernel.set.empty()) << "all are above the planner";
  runtime.planner_priority = 51;
  runtime.torque_priority = 58;
  ASSERT_TRUE(raise_interrupts(kBuses, runtime, kernel.answer()));
  EXPECT_EQ(kernel.set, (std::vector<std::pair<int, int>>{{117, 54}}));
}

TEST(InterruptPriorities, ARefusalNamesBusThreadAndReason) {
  Kernel kernel;
  kernel.refusal = "it takes root";
  const auto text = raise_interrupts(kBuses, {}, kernel.answer());
  ASSERT_FALSE(text);
  EXPECT_EQ(text.error(),
            "can0: irq/45-peak_pciefd (process 117, priority 50) keeps its priority: it takes root");
}

TEST(InterruptPriorities, AnInterfaceThatIsNotThereIsAMistake) {
  const auto text = raise_interrupts({{"can7", "", {}}}, {}, Kernel().answer());
  ASSERT_FALSE(text);
  EXPECT_EQ(text.error(), "can7: there is no such interface or no adapter");
}

TEST(InterruptPriorities, OnlyBusesWithoutHardwareMayLackAnAdapter) {
  for (const char* bus : {"loopback:left", "fdcanusb:/dev/ttyACM0", "vcan0", "lo"})
    EXPECT_TRUE(may_lack_adapter(bus)) << bus;
  for (const char* bus : {"nosuchcan0", "cam0", ""}) EXPECT_FALSE(may_lack_adapter(bus)) << bus;
}

}  // namespace
}  // namespace stilt::program
