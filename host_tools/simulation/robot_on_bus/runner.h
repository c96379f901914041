#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "host_tools/simulation/robot_on_bus/bus_ends.h"
#include "host_tools/simulation/robot_on_bus/robot_bus.h"
#include "host_tools/simulation/robot_on_bus/robot_on_bus.h"

namespace stilt::robot_on_bus {

/// When a run ends, and its observers.
struct RunOptions {
  double tick_s = 0.001;
  std::optional<double> duration_s;  ///< after the release by the gantry; none: until interrupted
  bool once = false;                 ///< whether the run ends when its controller has left
  double wait_s = 60.0;              ///< lock-step: longest wait for a controller, and for its turn
  double next_wait_s = 10.0;         ///< lock-step: longest wait for the next controller after one has left
  const std::atomic<bool>* stop = nullptr;  ///< set by another thread to end the run at once
  /// Set by another thread to end the run once no controller is connected: it sits the robot down first.
  const std::atomic<bool>* stop_after_controller = nullptr;
  double stop_wait_s = 30.0;  ///< longest wait for that, of the robot's time
  /// About once per simulated second.
  std::function<void(const RobotOnBus& robot)> progress = [](const RobotOnBus&) {};
  /// Real time: receives the bytes of a torso sensor on a serial port.
  std::function<void(std::span<const std::uint8_t>)> serial = [](std::span<const std::uint8_t>) {};
  std::function<void(const RobotOnBus&)> watch = [](const RobotOnBus&) {};  ///< about once per tick; must be
                                                                            ///< quick
};

/// Result of a run.
struct RunOutcome {
  bool has_priority = false;      ///< real time: the kernel granted SCHED_FIFO
  const char* ended = "";         ///< reason for the end
  std::uint64_t controllers = 0;  ///< number that connected, as far as the buses show it
  /// When each controller came, on the robot's clock: where the controller's own clock starts. A loopback bus
  /// shows it when it connects, SocketCAN with its first frame, where all frames count as one controller's.
  std::vector<double> controllers_came_s;
  std::uint64_t late = 0;   ///< real time: number of times that the robot was late and skipped the lost
                            ///< time
  double late_max_s = 0.0;  ///< longest of these delays
};

/// Runs the robot in turns with the controller. After a controller has left (loopback), the robot continues
/// alone for one second of its time, so that watchdogs expire. It then waits for the next controller. After
/// one that is silent for wait_s it continues in the same way, and ends. Throws std::runtime_error, one
/// sentence, when the controller violates the protocol.
[[nodiscard]] RunOutcome run_lockstep(RobotOnBus& robot, std::vector<RobotBus>& buses, FrameLog& log,
                                      const RunOptions& options);

/// Runs the robot by CLOCK_MONOTONIC. Commands become active when they arrive, replies leave at once, and the
/// torso sensor sends once per tick. Takes SCHED_FIFO above any controller when the kernel grants it, because
/// motor drivers do not wait for a processor. When the robot is more than 5 ms late, it skips the lost time
/// instead of catching up in a burst, and counts it.
[[nodiscard]] RunOutcome run_realtime(RobotOnBus& robot, std::vector<RobotBus>& buses, FrameLog& log,
                                      const RunOptions& options);

}  // namespace stilt::robot_on_bus
