#pragma once

#include <array>
#include <vector>

#include "hal/can/frame.h"
#include "hal/robot/robot_wiring.h"
#include "hal/sensors/torso_sensor_table.h"

namespace stilt::robot_on_bus {

/// Values of the channels, indexed by BaseChannel, SI units.
using BaseValues = std::array<double, hal::kBaseChannels>;

/// The transmit side of the torso sensor's channel table: one frame per identifier, as long as its channels
/// need.
class TorsoSensorFrames {
 public:
  explicit TorsoSensorFrames(const hal::RobotWiring& wiring);

  /// Every frame of the sensor with these values, in the order of the table. Values out of a field's range
  /// are clamped.
  [[nodiscard]] const std::vector<hal::CanFrame>& encode(const BaseValues& values);

 private:
  struct Row {
    hal::ChannelRow channel;
    std::size_t frame = 0;
  };
  std::vector<Row> rows_;
  std::vector<hal::CanFrame> frames_;
};

}  // namespace stilt::robot_on_bus
