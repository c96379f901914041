#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "firmware/configuration/configuration.h"
#include "firmware/control_loop/control_loop.h"
#include "firmware/control_loop/mailboxes.h"
#include "firmware/control_loop/planner_task.h"
#include "host_tools/recording/replay/recorded_robot.h"
#include "host_tools/recording/replay/replay.h"

namespace stilt::replay {

/// A run of the controller on a robot that does exactly what was planned, a little noise on the sensors.
/// Drivers up, standing, stepping, walking, and live tunables changed on the way. Everything it recorded.
struct RecordedWalk {
  configuration::Configuration configuration;
  std::vector<control_loop::TickRecord> ticks;
  std::vector<control_loop::CycleRecord> cycles;
  std::map<std::uint32_t, Tunings> tunings;                  ///< by their number
  std::map<std::uint32_t, std::vector<double>> live_values;  ///< the same, in the order of live_tunables()
};

inline constexpr unsigned kWalkSeed = 5;

/// The same one at each call, made once.
[[nodiscard]] const RecordedWalk& recorded_walk();

}  // namespace stilt::replay
