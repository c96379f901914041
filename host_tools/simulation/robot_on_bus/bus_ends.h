#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hal/can/frame_bus.h"
#include "host_tools/simulation/robot_on_bus/frame_log.h"
#include "host_tools/simulation/robot_on_bus/robot_on_bus.h"

namespace stilt::robot_on_bus {

/// The robot's ends of its buses: moves frames between them and the robot, and writes the frame log. Nothing
/// here waits.
class BusEnds {
 public:
  /// @param buses  in the order of the wiring; outlive this object, as do robot and log
  BusEnds(RobotOnBus& robot, std::span<hal::FrameBus* const> buses, FrameLog& log);

  [[nodiscard]] std::size_t count() const { return buses_.size(); }

  /// Takes everything that waits on a bus.
  [[nodiscard]] std::vector<hal::CanFrame> receive(std::size_t bus);

  /// Gives the robot a frame of the controller.
  void deliver(std::int64_t now_ns, std::size_t bus, const hal::CanFrame& frame);

  /// Puts what the robot's nodes send on the buses.
  void send_outgoing(std::int64_t now_ns);

  /// Puts a frame on a bus, after those that found its queue full before.
  void send(std::size_t bus, const hal::CanFrame& frame);

  /// Tries again to send what found the queue full.
  void flush(std::size_t bus);

  /// The controller is gone: what waits is dropped.
  void forget();

 private:
  RobotOnBus& robot_;
  std::vector<hal::FrameBus*> buses_;
  FrameLog& log_;
  std::vector<std::vector<hal::CanFrame>> waiting_;
};

}  // namespace stilt::robot_on_bus
