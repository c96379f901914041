#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hal/can/frame_bus.h"
#include "host_tools/simulation/robot_on_bus/frame_log.h"
#include "host_tools/simulation/robot_on_bus/robot_on_bus.h"

namespace stilt::robot_on_bus {

/// The robot's ends of its buses: moves frames between them and the robot, and writes the frame log. Never
/// waits.
class BusEnds {
 public:
  /// @param buses  in the order of the wiring; must outlive this object, as must robot and log
  BusEnds(RobotOnBus& robot, std::span<hal::FrameBus* const> buses, FrameLog& log);

  [[nodiscard]] std::size_t count() const { return buses_.size(); }

  /// Reads all frames that wait on a bus.
  [[nodiscard]] std::vector<hal::CanFrame> receive(std::size_t bus);

  /// Delivers a frame of the controller to the robot.
  void deliver(std::int64_t now_ns, std::size_t bus, const hal::CanFrame& frame);

  /// Sends the frames of the robot's nodes.
  void send_outgoing(std::int64_t now_ns);

  /// Frames of the robot's nodes reach the log only.
  void discard_outgoing(std::int64_t now_ns);

  /// Sends a frame on a bus, after the frames that found its queue full.
  void send(std::size_t bus, const hal::CanFrame& frame);

  /// Sends again the frames that found the queue full.
  void flush(std::size_t bus);

  /// The controller has left: drops the waiting frames.
  void forget();

 private:
  [[nodiscard]] std::vector<hal::CanFrame> take_outgoing(std::int64_t now_ns, std::size_t bus);

  RobotOnBus& robot_;
  std::vector<hal::FrameBus*> buses_;
  FrameLog& log_;
  std::vector<std::vector<hal::CanFrame>> waiting_;
};

}  // namespace stilt::robot_on_bus
