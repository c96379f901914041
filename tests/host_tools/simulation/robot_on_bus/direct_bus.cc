#include "tests/host_tools/simulation/robot_on_bus/direct_bus.h"

#include <algorithm>

namespace stilt::robot_on_bus::testing_support {

hal::SendResult DirectBus::send(std::span<const hal::CanFrame> frames) noexcept {
  for (const hal::CanFrame& frame : frames) {
    sent.push_back(frame);
    robot_.receive(now_ns_, bus_, frame);
  }
  return {frames.size(), hal::BusStatus::ok};
}

hal::ReceiveResult DirectBus::receive(std::span<hal::CanFrame> frames) noexcept {
  const std::size_t count = std::min(frames.size(), waiting.size());
  std::copy_n(waiting.begin(), count, frames.begin());
  waiting.erase(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(count));
  return {count, waiting.empty() ? hal::BusStatus::ok : hal::BusStatus::more};
}

}  // namespace stilt::robot_on_bus::testing_support
