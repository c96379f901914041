#pragma once

#include <cstdint>
#include <string>

namespace stilt::program {

/// What systemd is told of a service of Type=notify: that it is ready, what it does, and that it lives.
/// Nothing happens where no service manager listens ($NOTIFY_SOCKET). For housekeeping, not for real-time
/// threads. See sd_notify(3).
class ServiceManager {
 public:
  /// At every turn of housekeeping. Life is told twice a second and only while the torque loop ticks: when it
  /// stops, the watchdog of the service ends the program, and the drivers' own have long acted.
  /// @param ticks  of the torque loop so far
  /// @param state  of the supervisor, told when it changes
  void tell(std::int64_t now_ns, long long ticks, const char* state);

  /// The program is about to end.
  void tell_end() const;

 private:
  std::int64_t told_ns_ = 0;
  long long told_ticks_ = 0;
  std::string told_state_;
};

}  // namespace stilt::program
