#include "firmware/program/interrupt_report.h"

#include <algorithm>

#include "firmware/program/interrupt_priorities.h"

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

std::string thread_text(const realtime::InterruptThread& thread) {
  return thread.name + " (process " + std::to_string(thread.process) + ", priority " +
         std::to_string(thread.priority) + ")";
}

std::vector<std::string> delay_sentences(const std::vector<realtime::BusInterrupts>& buses,
                                         const configuration::RuntimeParameters& runtime) {
  std::vector<std::string> sentences;
  const int between = interrupt_priority(runtime);
  for (const realtime::InterruptThread& thread : delayed_threads(buses, runtime)) {
    sentences.push_back(thread_text(thread) + " waits for the planner; as root, chrt -f -p " +
                        std::to_string(between) + " " + std::to_string(thread.process) + " puts it before");
  }
  return sentences;
}

std::vector<std::string> InterruptWatch::update(supervisor::State state) {
  const bool reset = before_ == supervisor::State::fault && state != supervisor::State::fault &&
                     state != supervisor::State::off;
  before_ = state;
  return reset ? delay_sentences(realtime::bus_interrupts(buses_, root_), runtime_)
               : std::vector<std::string>{};
}

std::vector<std::string> interrupt_sentences(const std::vector<realtime::BusInterrupts>& buses) {
  std::vector<std::string> sentences;
  for (const realtime::BusInterrupts& bus : buses) {
    if (bus.adapter.empty()) continue;
    std::string served;
    for (const realtime::InterruptThread& thread : bus.threads) {
      served.append(served.empty() ? "" : ", ").append(thread_text(thread));
    }
    const bool known = std::ranges::any_of(
        bus.threads, [](const auto& thread) { return !thread.name.starts_with("ksoftirqd/"); });
    if (!known) {
      served.insert(0, served.empty() ? "" : "; ");
      served.insert(0, "no interrupt thread is known; with PREEMPT_RT see /proc/interrupts");
    }
    sentences.push_back(bus.bus + " (" + bus.adapter + "): " + served);
  }
  return sentences;
}

}  // namespace stilt::program
