#include "firmware/realtime/capability.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/utsname.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <set>

#include "firmware/realtime/kernel_file.h"
#include "firmware/realtime/processor_state.h"
#include "firmware/realtime/thread.h"

namespace stilt::realtime {
namespace {

/// Tries the priority on this thread, and puts the old one back.
bool may_have_priority(int priority) {
  int policy = 0;
  sched_param before{};
  pthread_getschedparam(pthread_self(), &policy, &before);
  sched_param wanted{};
  wanted.sched_priority = priority;
  if (pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted) != 0) return false;
  pthread_setschedparam(pthread_self(), policy, &before);
  return true;
}

/// Tries the processor on this thread, and puts the old ones back. What a thread inherits is no answer:
/// isolcpus= takes processors from all that do not ask for them.
bool may_have_core(int core) {
  cpu_set_t before;
  CPU_ZERO(&before);
  if (sched_getaffinity(0, sizeof before, &before) != 0 || !take_core(core)) return false;
  sched_setaffinity(0, sizeof before, &before);
  return true;
}

void look_at_kernel(Capability& capability, const std::string& root) {
  utsname name{};
  uname(&name);
  capability.kernel = name.release;
  const bool says_so = std::strstr(name.version, "PREEMPT_RT") != nullptr;
  capability.realtime_kernel = says_so || first_line(root + "/sys/kernel/realtime") == "1";
  if (!capability.realtime_kernel) {
    capability.lacking.push_back("kernel " + capability.kernel + " is not PREEMPT_RT");
  }
}

void look_at_processors(Capability& capability, const Requirements& requirements, const std::string& root) {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  sched_getaffinity(0, sizeof allowed, &allowed);
  for (const int core : {requirements.torque_core, requirements.planner_core}) {
    if (!may_have_core(core)) {
      capability.lacking.push_back("processor " + std::to_string(core) + " is not there for this program");
    } else if (core >= 0) {
      CPU_SET(static_cast<std::size_t>(core), &allowed);
    }
  }
  capability.cores = CPU_COUNT(&allowed);
  if (capability.cores < 2) {
    capability.lacking.push_back("torque loop and planner share one processor");
  } else if (requirements.torque_core >= 0 && requirements.torque_core == requirements.planner_core) {
    capability.lacking.push_back("torque loop and planner are both set to processor " +
                                 std::to_string(requirements.torque_core));
  }
  const std::string all = root + "/sys/devices/system/cpu/";
  capability.torque_core = requirements.torque_core;
  capability.core_isolated =
      requirements.torque_core >= 0 && has_processor(first_line(all + "isolated"), requirements.torque_core);
  const auto governor_of = [&all](int core) {
    return first_line(all + "cpu" + std::to_string(core) + "/cpufreq/scaling_governor");
  };
  const int torque_core = std::max(0, requirements.torque_core);
  capability.governor = governor_of(torque_core);
  const int planner_core = requirements.planner_core < 0 ? torque_core : requirements.planner_core;
  for (const int core : std::set{torque_core, planner_core}) {
    const std::string governor = governor_of(core);
    if (governor.empty() || governor == "performance") continue;
    capability.lacking.push_back("frequency governor of processor " + std::to_string(core) + " is " +
                                 governor + ", not performance");
  }
}

/// Real-time threads that have used up their share of a period stand still until it ends.
void look_at_throttling(Capability& capability, const std::string& root) {
  constexpr double kLeastShare = 0.95;  // the kernel's default
  const std::string folder = root + "/proc/sys/kernel/sched_rt_";
  const std::string runtime_us = first_line(folder + "runtime_us");
  const std::string period_us = first_line(folder + "period_us");
  const double share = std::atof(runtime_us.c_str()) / std::atof(period_us.c_str());
  if (runtime_us.empty() || runtime_us.front() == '-' || !(share < kLeastShare)) return;
  capability.lacking.push_back("kernel.sched_rt_runtime_us is " + runtime_us + " of " + period_us +
                               " us, so that real-time threads may stand still; 95 % or -1 would be right");
}

/// A request that is not granted lacks only where the kernel has idle states that are too slow to leave.
void shorten_idle_states(Capability& capability, const Requirements& requirements, const std::string& root) {
  capability.idle = IdleRequest(requirements.idle_exit_max_s, root);
  const auto deepest = deepest_idle_state(requirements.torque_core, root);
  if (capability.idle.held() || !deepest || deepest->exit_us <= 1e6 * requirements.idle_exit_max_s) return;
  capability.lacking.push_back(
      "a processor takes " + std::to_string(std::lround(deepest->exit_us)) + " us to leave idle state " +
      deepest->name + ", and /dev/cpu_dma_latency cannot be held (" + capability.idle.reason() + ")");
}

}  // namespace

Capability acquire(const Requirements& requirements, const std::string& root) {
  Capability capability;
  look_at_kernel(capability, root);
  look_at_processors(capability, requirements, root);
  look_at_throttling(capability, root);
  shorten_idle_states(capability, requirements, root);
  capability.memory_locked = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  if (!capability.memory_locked) {
    capability.lacking.push_back(std::string("memory cannot be locked (") + std::strerror(errno) + ")");
  }
  const int highest = std::max(requirements.torque_priority, requirements.planner_priority);
  capability.priority_allowed = highest > 0 && may_have_priority(highest);
  if (requirements.torque_priority <= 0) {
    capability.lacking.push_back("the torque loop is set to no priority");
  } else if (!capability.priority_allowed) {
    capability.lacking.push_back("SCHED_FIFO priority " + std::to_string(highest) + " is not permitted");
  }
  return capability;
}

std::string lacking_text(const Capability& capability) {
  std::string text;
  for (const std::string& sentence : capability.lacking) text += (text.empty() ? "" : "; ") + sentence;
  return text;
}

}  // namespace stilt::realtime
