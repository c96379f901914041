#include "firmware/program/service_manager.h"

#include <systemd/sd-daemon.h>

#include <cmath>
#include <utility>

namespace stilt::program {
namespace {

constexpr std::int64_t kPeriod_ns = 500'000'000;
constexpr int kKeepEnvironment = 0;

/// Empty where the service has no watchdog, or one that waits long enough.
std::string longer_watchdog(double needed_s) {
  const auto needed_us = static_cast<std::uint64_t>(std::llround(1e6 * needed_s));
  std::uint64_t given_us = 0;
  if (sd_watchdog_enabled(kKeepEnvironment, &given_us) <= 0 || given_us >= needed_us) return {};
  return "WATCHDOG_USEC=" + std::to_string(needed_us) + '\n';
}

}  // namespace

void ServiceManager::notify(std::int64_t now_ns, long long ticks, const char* state) {
  std::string message;
  if (notified_ticks_ == 0 && ticks > 0) message += "READY=1\n" + longer_watchdog(longest_alone_s_);
  if (ticks > notified_ticks_ && now_ns - notified_ns_ >= kPeriod_ns) {
    message += "WATCHDOG=1\n";
    notified_ticks_ = ticks;
    notified_ns_ = now_ns;
  }
  if (notified_state_ != state) {
    message += std::string("STATUS=") + state + '\n';
    notified_state_ = state;
  }
  if (!message.empty()) sd_notify(kKeepEnvironment, message.c_str());
}

void ServiceManager::notify_stop_asked() {
  if (std::exchange(stop_notified_, true)) return;
  const std::string message = "EXTEND_TIMEOUT_USEC=" + std::to_string(std::llround(1e6 * longest_stop_s_));
  sd_notify(kKeepEnvironment, message.c_str());
}

void ServiceManager::notify_stopping() const { sd_notify(kKeepEnvironment, "STOPPING=1"); }

}  // namespace stilt::program
