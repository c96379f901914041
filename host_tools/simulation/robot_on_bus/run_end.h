#pragma once

#include <optional>
#include <vector>

#include "host_tools/simulation/robot_on_bus/robot_bus.h"
#include "host_tools/simulation/robot_on_bus/runner.h"

/// Functions that both runners share.
namespace stilt::robot_on_bus {

/// Looks for the end of a run.
class RunEnd {
 public:
  /// @param options  must outlive this object
  explicit RunEnd(const RunOptions& options) : options_(options) {}

  /// Why the run is over; null while it is not.
  [[nodiscard]] const char* reason(const RobotOnBus& robot, bool has_controller);

 private:
  /// Whether it is, and the run waits no longer for its controller to end.
  [[nodiscard]] bool is_asked_to_end(const RobotOnBus& robot, bool has_controller);

  const RunOptions& options_;
  std::optional<double> asked_s_;
};

/// Whether a controller is connected to every bus.
[[nodiscard]] bool all_connected(const std::vector<RobotBus>& buses);

/// Whether a controller is connected to any bus.
[[nodiscard]] bool any_connected(const std::vector<RobotBus>& buses);

/// Sleeps until a frame arrives on a connected bus, at most timeout_ns.
void wait_for_frames(const RobotOnBus& robot, const std::vector<RobotBus>& buses, std::int64_t timeout_ns);

[[nodiscard]] std::vector<hal::FrameBus*> frame_buses(std::vector<RobotBus>& buses);

/// Calls the observer, and reports progress once per second of the robot's time.
class ProgressTicks {
 public:
  void update(const RobotOnBus& robot, const RunOptions& options);

 private:
  double next_s_ = 1.0;
};

}  // namespace stilt::robot_on_bus
