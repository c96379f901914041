#pragma once

#include <string>
#include <vector>

#include "host_tools/cli/robot_command.h"
#include "host_tools/simulation/robot_on_bus/robot_on_bus.h"
#include "mpc_core/model/robot.h"

namespace stilt::cli {

/// The robot that `stilt robot` simulates, and its buses.
struct SimulatedHardware {
  robot_on_bus::RobotSetup setup;
  std::vector<std::string> bus_names;
  bool fd = false;          ///< whether a driver uses CAN FD
  std::string serial_port;  ///< of the torso sensor; empty: it is on a bus
  const model::RobotModel* robot = nullptr;
};

/// The mistakes of --miswired as text, one per line.
[[nodiscard]] std::string describe_mistakes();

/// Reads and checks the options. Throws UsageError or std::invalid_argument, one sentence.
[[nodiscard]] SimulatedHardware simulated_hardware(const RobotOptions& options);

}  // namespace stilt::cli
