#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "hal/can/bus_load.h"
#include "hal/can/identifiers.h"
#include "hal/robot/robot_wiring.h"

namespace stilt::hal {

/// Everything that is periodically on a bus of a valid wiring. Commands and replies come at the rate of the
/// torque loop, heartbeats of ODrives at 10 Hz. Torso sensor frames come at their rate, as long as their
/// channels need.
[[nodiscard]] std::vector<PeriodicFrame> periodic_frames(const RobotWiring& wiring, std::size_t bus,
                                                         double tick_hz, double sensor_hz);

/// The identifiers that a driver of any family, or a frame of a sensor, uses.
[[nodiscard]] NodeIdentifiers identifiers(const JointDriver& driver);
[[nodiscard]] NodeIdentifiers identifiers(const ChannelRow& channel);

/// Identifiers of all frames on a bus, ours and theirs.
[[nodiscard]] std::vector<FrameId> receive_ids(const RobotWiring& wiring, std::size_t bus);

/// Whether a driver on the bus needs CAN FD.
[[nodiscard]] bool uses_fd(const RobotWiring& wiring, std::size_t bus) noexcept;

/// One sentence about a bus for the user: its load, and what to do about it when it is high. Start-up only.
[[nodiscard]] std::string load_sentence(const std::string& bus_name, const BusLoad& load);

}  // namespace stilt::hal
