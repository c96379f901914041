#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "host_tools/simulation/robot_on_bus/bus_ends.h"

namespace stilt::robot_on_bus {

/// The robot's side of lock-step (hal/can/lockstep.h). Time is virtual, one tick per sync frame of the
/// controller: the result does not depend on the speed of either side. Frames are delivered bus by bus once
/// the controller has ended its turn on all buses. The result does not depend on their order in time either.
///
/// A restarted controller begins with tick 0 again; the robot's own time continues.
class LockstepExchange {
 public:
  /// @param connections  number of controllers that have connected to a bus so far
  LockstepExchange(RobotOnBus& robot, BusEnds& ends, double tick_s,
                   std::function<std::uint64_t(std::size_t)> connections);

  /// Reads the frames that have arrived. When the controller's turn is over, advances the robot by a tick
  /// (not for tick 0). Then sends the frames of its nodes, ends the robot's turn, and returns true. Never
  /// waits. Throws std::runtime_error, one sentence, when the controller's tick number is wrong.
  bool poll();

  /// Advances the robot by one tick without a controller. A controller that is connected already gets
  /// nothing: the frames of many ticks would fill its queue before its first turn.
  void advance_alone();

  /// The controller has left: resets the exchange. A bus on which the next controller has begun its turn
  /// already keeps that turn.
  void forget_controller();

  /// connections() of each bus for the controller of the last turn that was answered.
  [[nodiscard]] std::span<const std::uint64_t> controller() const { return controller_; }

  /// The tick of both sides; nothing before tick 0 was exchanged.
  [[nodiscard]] std::optional<std::uint64_t> tick() const { return tick_; }

 private:
  struct Turn {
    std::vector<hal::CanFrame> frames;
    std::optional<std::uint64_t> ended;  ///< tick of the controller's ended turn
    std::uint64_t connection = 0;        ///< whose turn it is
  };
  void take(std::size_t bus);
  [[nodiscard]] bool all_ended() const;
  void check_tick() const;
  [[nodiscard]] std::int64_t now_ns() const;

  RobotOnBus& robot_;
  BusEnds& ends_;
  std::int64_t tick_ns_;
  std::function<std::uint64_t(std::size_t)> connections_;
  std::vector<Turn> turns_;
  std::vector<std::uint64_t> controller_;
  std::optional<std::uint64_t> tick_;
};

}  // namespace stilt::robot_on_bus
