#pragma once

#include <string>
#include <vector>

#include "host_tools/cli/robot_command.h"
#include "host_tools/simulation/robot_on_bus/robot_on_bus.h"
#include "mpc_core/model/robot.h"

namespace stilt::cli {

/// What `stilt robot` simulates, from its options: the robot, and the buses it is on.
struct SimulatedHardware {
  robot_on_bus::RobotSetup setup;
  std::vector<std::string> bus_names;
  bool fd = false;  ///< a driver speaks CAN FD
  const model::RobotModel* robot = nullptr;
};

/// Everything checked. Throws UsageError or std::invalid_argument, one sentence.
[[nodiscard]] SimulatedHardware simulated_hardware(const RobotOptions& options);

}  // namespace stilt::cli
