#include "firmware/program/interrupt_report.h"

#include <algorithm>

namespace stilt::program {

std::vector<realtime::InterruptThread> delayed_threads(const std::vector<realtime::BusInterrupts>& buses,
                                                       const configuration::RuntimeParameters& runtime) {
  std::vector<realtime::InterruptThread> delayed;
  for (const realtime::BusInterrupts& bus : buses) {
    for (const realtime::InterruptThread& thread : bus.threads) {
      const bool twice =
          std::ranges::any_of(delayed, [&](const auto& other) { return other.process == thread.process; });
      if (twice || thread.name.starts_with("ksoftirqd/") || thread.priority > runtime.planner_priority ||
          !realtime::has_processor(thread.processors, runtime.planner_core)) {
        continue;
      }
      delayed.push_back(thread);
    }
  }
  return delayed;
}

std::vector<std::string> interrupt_sentences(const std::vector<realtime::BusInterrupts>& buses) {
  std::vector<std::string> sentences;
  for (const realtime::BusInterrupts& bus : buses) {
    if (bus.adapter.empty()) continue;
    std::string served;
    for (const realtime::InterruptThread& thread : bus.threads) {
      served.append(served.empty() ? "" : ", ").append(thread.name);
      served.append(" (process ").append(std::to_string(thread.process));
      served.append(", priority ").append(std::to_string(thread.priority)).append(")");
    }
    const bool known = std::ranges::any_of(
        bus.threads, [](const auto& thread) { return !thread.name.starts_with("ksoftirqd/"); });
    if (!known) {
      served = "no interrupt thread is known; with PREEMPT_RT see /proc/interrupts" +
               (served.empty() ? "" : "; " + served);
    }
    sentences.push_back(bus.bus + " (" + bus.adapter + "): " + served);
  }
  return sentences;
}

}  // namespace stilt::program
