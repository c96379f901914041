#pragma once

#include <expected>
#include <functional>
#include <string>

#include "firmware/commissioning/session.h"

/// Joints, torso, emergency stop, live, while nothing gives torque. Ordinary threads.
namespace stilt::commissioning {

/// Readings at one moment.
struct WatchSample {
  double time_s = 0.0;  ///< since the drivers were up
  hal::RobotReadings readings;
};

/// Brings the drivers up and keeps them limp: no frame asks for a torque or a gain. At the end the drivers
/// are off.
/// @param duration_s  0: until the session is stopped
/// @param show        gets a sample every 0.1 s
/// @param follow      gets one every tick; false ends the watch
/// @return  the error names joint and cause
[[nodiscard]] std::expected<void, std::string> watch(
    Session& session, double duration_s, const std::function<void(const WatchSample&)>& show,
    const std::function<bool(const WatchSample&)>& follow = [](const WatchSample&) { return true; });

/// Whether every joint and the torso report, and no driver has a fault or is off. An emergency stop that is
/// configured must report that it is released.
[[nodiscard]] bool good(const WatchSample& sample);

/// A table of kWatchLines lines, none longer than a terminal of 80 columns: one that wraps is not drawn over.
[[nodiscard]] std::string to_table(const WatchSample& sample);
inline constexpr int kWatchLines = 9;

/// One line of JSON.
[[nodiscard]] std::string to_json_line(const WatchSample& sample);

}  // namespace stilt::commissioning
