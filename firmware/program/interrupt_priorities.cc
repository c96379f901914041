#include "firmware/program/interrupt_priorities.h"

#include <net/if.h>
#include <sched.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "firmware/program/interrupt_report.h"

namespace stilt::program {

int interrupt_priority(const configuration::RuntimeParameters& runtime) noexcept {
  return (runtime.planner_priority + runtime.torque_priority) / 2;
}

bool may_lack_adapter(const std::string& bus) {
  for (const char* prefix : {"loopback:", "fdcanusb:", "vcan"}) {
    if (bus.starts_with(prefix)) return true;
  }
  return if_nametoindex(bus.c_str()) != 0;
}

std::string set_priority(int process, int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  if (sched_setscheduler(process, SCHED_FIFO, &parameters) == 0) return "";
  if (errno == EPERM) return "it takes root";
  return std::generic_category().message(errno);
}

std::expected<std::string, std::string> raise_interrupts(const std::vector<realtime::BusInterrupts>& buses,
                                                         const configuration::RuntimeParameters& runtime,
                                                         const SetPriority& set) {
  const int priority = interrupt_priority(runtime);
  std::string text;
  for (const realtime::BusInterrupts& bus : buses) {
    if (bus.adapter.empty()) return std::unexpected(bus.bus + ": there is no such interface or no adapter");
    bool known = false;
    for (const realtime::InterruptThread& thread : bus.threads) {
      if (thread.name.starts_with("ksoftirqd/")) continue;
      known = true;
      text += bus.bus + ": " + thread_text(thread);
      if (thread.priority > runtime.planner_priority) {
        text += " stays\n";
        continue;
      }
      const std::string reason = set(thread.process, priority);
      if (!reason.empty()) {
        return std::unexpected(bus.bus + ": " + thread_text(thread) + " keeps its priority: " + reason);
      }
      text += " has " + std::to_string(priority) + " now\n";
    }
    if (!known) text += bus.bus + ": no interrupt thread is known; with PREEMPT_RT see /proc/interrupts\n";
  }
  return text;
}

}  // namespace stilt::program
