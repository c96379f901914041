#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host_tools/simulation/robot_on_bus/bus_ends.h"

namespace stilt::robot_on_bus {

/// The robot's side of lock-step (hal/can/lockstep.h). Time is virtual: one tick for each sync frame of
/// the controller, so that nothing depends on how fast either side runs. Frames are delivered bus by bus once
/// the controller has ended its turn on all of them, so that nothing depends on their order in time either.
///
/// A controller that starts anew begins with tick 0 again; the robot's own time goes on.
class LockstepExchange {
 public:
  LockstepExchange(RobotOnBus& robot, BusEnds& ends, double tick_s);

  /// Takes what has arrived. When the controller's turn is over: advances the robot by a tick (not for tick
  /// 0), sends what its nodes say, and ends the robot's turn. Whether it did. Never waits. Throws
  /// std::runtime_error, one sentence, when the controller counts wrongly.
  bool poll();

  /// Advances the robot by one tick without a controller.
  void advance_alone();

  /// The controller is gone.
  void forget_controller();

  /// The tick that both sides are at; nothing before tick 0 was exchanged.
  [[nodiscard]] std::optional<std::uint64_t> tick() const { return tick_; }

 private:
  struct Turn {
    std::vector<hal::CanFrame> frames;
    std::optional<std::uint64_t> ended;  ///< with this tick
  };
  void take(std::size_t bus);
  [[nodiscard]] bool all_ended() const;
  void check_tick() const;
  [[nodiscard]] std::int64_t now_ns() const;

  RobotOnBus& robot_;
  BusEnds& ends_;
  std::int64_t tick_ns_;
  std::vector<Turn> turns_;
  std::optional<std::uint64_t> tick_;
};

}  // namespace stilt::robot_on_bus
