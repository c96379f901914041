#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>

#include "hal/can/bus_load.h"
#include "hal/robot/robot_wiring.h"

namespace stilt::hal {

/// Most kinds of frames on one bus: command, reply and state message of each joint, and each sensor frame.
inline constexpr std::size_t kMaximumPeriodic = 5 * kJoints + kMaximumChannels;

struct PeriodicFrames {
  std::array<PeriodicFrame, kMaximumPeriodic> frames{};
  std::size_t count = 0;

  /// Valid as long as this object.
  [[nodiscard]] std::span<const PeriodicFrame> all() const noexcept { return std::span(frames).first(count); }
};

/// Everything that is periodically on a bus of a valid wiring: commands and replies at the rate of the torque
/// loop, heartbeats of ODrives at 10 Hz, base-sensor frames at their rate (as long as their channels need).
[[nodiscard]] PeriodicFrames periodic_frames(const RobotWiring& wiring, std::size_t bus, double tick_hz,
                                             double sensor_hz) noexcept;

/// One sentence about a bus for the user: its load, and what to do about it when it is high. Start-up only.
[[nodiscard]] std::string load_sentence(const std::string& bus_name, const BusLoad& load);

}  // namespace stilt::hal
