#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "host_tools/simulation/robot_on_bus/bus_ends.h"
#include "host_tools/simulation/robot_on_bus/robot_bus.h"
#include "host_tools/simulation/robot_on_bus/robot_on_bus.h"

namespace stilt::robot_on_bus {

/// When a run ends, and who watches it.
struct RunOptions {
  double tick_s = 0.001;
  std::optional<double> duration_s;  ///< after the gantry has released the robot; none: until interrupted
  bool once = false;                 ///< end when the controller that came has left
  double wait_s = 60.0;              ///< lock-step: longest wait for a controller, and for its turn
  double next_wait_s = 10.0;         ///< lock-step: longest wait for the next controller after one has left
  const std::atomic<bool>* stop = nullptr;                      ///< set from outside to end the run
  std::function<void(double time_s)> progress = [](double) {};  ///< about once a simulated second
  std::function<void(const RobotOnBus&)> watch = [](const RobotOnBus&) {};  ///< about every tick; quick
};

/// How a run went.
struct RunOutcome {
  bool has_priority = false;      ///< real time: the kernel granted SCHED_FIFO
  const char* ended = "";         ///< why
  std::uint64_t controllers = 0;  ///< that came, as far as the buses know
  std::uint64_t late = 0;         ///< real time: how often the robot fell behind the clock and let it go
  double late_max_s = 0.0;        ///< by how much at most
};

/// The robot follows the controller's turns. After a controller has left (loopback), the robot goes on alone
/// for one second of its time, so that watchdogs expire, then waits for the next one. Throws
/// std::runtime_error, one sentence, when the controller breaks the rules or says nothing for wait_s.
[[nodiscard]] RunOutcome run_lockstep(RobotOnBus& robot, std::vector<RobotBus>& buses, FrameLog& log,
                                      const RunOptions& options);

/// The robot follows CLOCK_MONOTONIC. Commands take effect when they arrive, replies leave at once, the base
/// sensor sends once per tick. Takes SCHED_FIFO above any controller when the kernel grants it: motor drivers
/// do not wait for a processor. A robot that falls behind by more than 5 ms leaves the lost time out instead
/// of catching up in a burst, and counts it.
[[nodiscard]] RunOutcome run_realtime(RobotOnBus& robot, std::vector<RobotBus>& buses, FrameLog& log,
                                      const RunOptions& options);

}  // namespace stilt::robot_on_bus
