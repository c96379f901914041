#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "hal/can/frame.h"
#include "hal/robot/robot_wiring.h"

namespace stilt::hal {

/// Drivers of a bus that exchange the frames of a classic protocol as CAN FD frames (JointWiring::can_fd):
/// the same identifiers and bytes. Codecs and bring-up use classic frames alone. Remote frames stay classic,
/// as CAN FD has none. Source, for Damiao: github.com/enactic/openarm_can at 1170b54, use_fd; for ODrive:
/// can.config.data_baud_rate and tx_brs of its firmware 0.6. Fixed memory, real-time safe.
class FlexibleFrames {
 public:
  FlexibleFrames() = default;
  FlexibleFrames(const RobotWiring& wiring, std::size_t bus) noexcept;

  /// A frame as it goes on the bus.
  [[nodiscard]] CanFrame to_bus(const CanFrame& frame) const noexcept;

  /// A frame of the bus as the codecs take it. A classic one stays as it is: what a driver answers with is
  /// its choice.
  [[nodiscard]] CanFrame from_bus(const CanFrame& frame) const noexcept;

  [[nodiscard]] bool empty() const noexcept { return count_ == 0; }

 private:
  struct Identifiers {
    std::uint32_t value = 0;
    std::uint32_t mask = kMaximumStandardId;
    bool bit_rate_switch = false;
  };
  [[nodiscard]] const Identifiers* find(const CanFrame& frame) const noexcept;
  void add(Identifiers identifiers) noexcept;

  std::array<Identifiers, std::tuple_size_v<DriverStandardIds> * kJoints> identifiers_{};
  std::size_t count_ = 0;
};

}  // namespace stilt::hal
