#pragma once

#include <vector>

#include "firmware/configuration/configuration.h"
#include "firmware/controller/mailboxes.h"
#include "firmware/controller/planner_cycle.h"
#include "firmware/controller/planning_turn.h"
#include "firmware/controller/torque_cycle.h"
#include "host_tools/replay/recorded_robot.h"

namespace stilt::replay {

/// A run of the controller on a robot that does exactly what was planned, a little noise on the sensors:
/// drivers up, standing, stepping, walking. Everything it recorded.
struct RecordedWalk {
  configuration::Configuration configuration;
  std::vector<diagnostics::TickRecord> ticks;
  std::vector<controller::CycleRecord> cycles;
};

inline constexpr unsigned kWalkSeed = 5;

/// The same one at each call, made once.
[[nodiscard]] const RecordedWalk& recorded_walk();

}  // namespace stilt::replay
