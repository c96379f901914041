#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "hal/can/frame_bus.h"
#include "host_tools/simulation/robot_on_bus/robot_on_bus.h"

namespace stilt::robot_on_bus::testing_support {

/// The controller's end of a bus that leads straight to the simulated robot.
class DirectBus final : public hal::FrameBus {
 public:
  DirectBus(RobotOnBus& robot, std::size_t bus, const std::int64_t& now_ns)
      : robot_(robot), bus_(bus), now_ns_(now_ns) {}

  [[nodiscard]] hal::SendResult send(std::span<const hal::CanFrame> frames) noexcept override;
  [[nodiscard]] hal::ReceiveResult receive(std::span<hal::CanFrame> frames) noexcept override;
  [[nodiscard]] hal::BusHealth health() const noexcept override { return hal::BusHealth::active; }
  void clear_bus_off() noexcept override {}
  [[nodiscard]] const hal::BusCounters& counters() const noexcept override { return counters_; }

  std::deque<hal::CanFrame> waiting;  ///< frames on their way to the controller
  std::vector<hal::CanFrame> sent;    ///< all that the controller has sent

 private:
  RobotOnBus& robot_;
  std::size_t bus_;
  const std::int64_t& now_ns_;
  hal::BusCounters counters_;
};

}  // namespace stilt::robot_on_bus::testing_support
