#pragma once

#include <vector>

#include "host_tools/simulation/robot_on_bus/robot_bus.h"
#include "host_tools/simulation/robot_on_bus/runner.h"

/// What both runners share.
namespace stilt::robot_on_bus {

/// Why a run is over, or null while it is not.
[[nodiscard]] const char* reason_to_end(const RobotOnBus& robot, const RunOptions& options);

/// Whether a controller is on every bus.
[[nodiscard]] bool all_connected(const std::vector<RobotBus>& buses);

/// Whether a controller is on any bus.
[[nodiscard]] bool any_connected(const std::vector<RobotBus>& buses);

/// Sleeps until something arrives on a bus that is there, at most that long.
void wait_for_frames(const RobotOnBus& robot, const std::vector<RobotBus>& buses, std::int64_t timeout_ns);

[[nodiscard]] std::vector<hal::FrameBus*> frame_buses(std::vector<RobotBus>& buses);

/// Lets those who watch look, and reports progress once per second of the robot's time.
class ProgressTicks {
 public:
  void update(const RobotOnBus& robot, const RunOptions& options);

 private:
  double next_s_ = 1.0;
};

}  // namespace stilt::robot_on_bus
