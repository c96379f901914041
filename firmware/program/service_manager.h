#pragma once

#include <cstdint>
#include <string>

#include "firmware/supervisor/parameters.h"

namespace stilt::program {

/// What a service reports to systemd, being of Type=notify: that it is ready, what it does, and signs of
/// life. Nothing happens where no service manager listens ($NOTIFY_SOCKET). For housekeeping, not for
/// real-time threads. See sd_notify(3).
class ServiceManager {
 public:
  explicit ServiceManager(const supervisor::SupervisorParameters& parameters) noexcept
      : longest_stop_s_(2 * parameters.slow_down_s + parameters.sit_s + parameters.damped_before_off_s +
                        kStopMargin_s),
        longest_alone_s_(parameters.operator_gone_s + longest_stop_s_) {}

  /// At every turn of housekeeping. A sign of life goes out twice per second and only while the torque loop
  /// ticks. When it stops, the watchdog of the service ends the program, and the drivers' own have long
  /// acted. With the first one the watchdog is made to wait until a robot without housekeeping sat down and
  /// was damped.
  /// @param ticks  of the torque loop so far
  /// @param state  of the supervisor, sent when it changes
  void notify(std::int64_t now_ns, long long ticks, const char* state);

  /// A signal has asked for the end: to step, stand, sit and be damped may take longer than TimeoutStopSec=
  /// of the service. Sent once.
  void notify_stop_asked();

  /// The program is about to end.
  void notify_stopping() const;

 private:
  static constexpr double kStopMargin_s = 5.0;

  double longest_stop_s_;
  double longest_alone_s_;  ///< from the last turn of housekeeping until the robot sat down and was damped
  bool stop_notified_ = false;
  std::int64_t notified_ns_ = 0;
  long long notified_ticks_ = 0;
  std::string notified_state_;
};

}  // namespace stilt::program
