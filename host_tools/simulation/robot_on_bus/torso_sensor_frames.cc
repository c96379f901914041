#include "host_tools/simulation/robot_on_bus/torso_sensor_frames.h"

#include <algorithm>

namespace stilt::robot_on_bus {
namespace {

std::size_t end_byte(const hal::ChannelRow& row) {
  return row.byte_offset + (static_cast<std::size_t>(row.bits) + row.bit_offset + 7) / 8;
}

}  // namespace

TorsoSensorFrames::TorsoSensorFrames(const hal::RobotWiring& wiring) {
  for (std::size_t i = 0; i < wiring.channel_count; ++i) {
    const hal::ChannelRow& row = wiring.channels[i];
    const auto same = std::ranges::find_if(frames_, [&row](const hal::CanFrame& frame) {
      return frame.id == row.id && frame.extended == row.extended;
    });
    const auto index = static_cast<std::size_t>(same - frames_.begin());
    if (same == frames_.end()) {
      frames_.push_back(hal::classic_frame(row.id, 0));
      frames_.back().extended = row.extended;
    }
    hal::CanFrame& frame = frames_[index];
    frame.length = std::max(frame.length, hal::fd_length(end_byte(row)));
    frame.fd = frame.length > hal::kClassicFrameBytes;
    rows_.push_back({row, index});
  }
}

const std::vector<hal::CanFrame>& TorsoSensorFrames::encode(const BaseValues& values) {
  for (const Row& row : rows_) {
    const double value = values[static_cast<std::size_t>(row.channel.channel)];
    static_cast<void>(hal::encode(row.channel, value, frames_[row.frame]));  // cannot fail: valid row, finite
                                                                             // value
  }
  return frames_;
}

}  // namespace stilt::robot_on_bus
