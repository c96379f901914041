#include "hal/robot/robot_wiring.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace stilt::hal {
namespace {

bool valid_driver(const JointWiring& joint) noexcept {
  if (const auto* mit = std::get_if<protocol::MitDriver>(&joint.driver)) return protocol::valid(*mit);
  if (const auto* moteus = std::get_if<protocol::MoteusDriver>(&joint.driver))
    return protocol::valid(*moteus);
  const auto* odrive = std::get_if<OdriveNode>(&joint.driver);
  return odrive != nullptr && odrive->node <= protocol::kOdriveMaximumNode;
}

/// Kind of protocol and identifier a driver listens to: equal means the same driver.
std::uint32_t address(const JointWiring& joint) noexcept {
  const auto kind = static_cast<std::uint32_t>(joint.driver.index()) << 16;
  if (const auto* mit = std::get_if<protocol::MitDriver>(&joint.driver)) return kind | mit->command_id;
  if (const auto* moteus = std::get_if<protocol::MoteusDriver>(&joint.driver)) return kind | moteus->id;
  const auto* odrive = std::get_if<OdriveNode>(&joint.driver);
  return kind | (odrive != nullptr ? odrive->node : 0u);
}

}  // namespace

bool valid(const RobotWiring& wiring, std::size_t bus_count) noexcept {
  if (bus_count == 0 || bus_count > kMaximumBuses || wiring.channel_count > kMaximumChannels ||
      wiring.channel_bus >= bus_count || wiring.pitch_encoder_joint >= static_cast<int>(kJoints)) {
    return false;
  }
  for (std::size_t i = 0; i < kJoints; ++i) {
    const JointWiring& joint = wiring.joints[i];
    if (joint.bus >= bus_count || std::abs(joint.direction) != 1 || !(joint.ratio > 0) ||
        !std::isfinite(joint.ratio) || !std::isfinite(joint.offset_rad) || !valid_driver(joint)) {
      return false;
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (wiring.joints[j].bus == joint.bus && address(wiring.joints[j]) == address(joint)) return false;
    }
  }
  if (wiring.pitch_encoder_joint >= 0) {
    const auto* moteus = std::get_if<protocol::MoteusDriver>(
        &wiring.joints[static_cast<std::size_t>(wiring.pitch_encoder_joint)].driver);
    if (moteus == nullptr || moteus->extra_encoder < 0) return false;
  }
  const auto rows = std::span(wiring.channels).first(wiring.channel_count);
  return std::abs(wiring.pitch_direction) == 1 && std::isfinite(wiring.pitch_offset_rad) &&
         std::all_of(rows.begin(), rows.end(),
                     [](const protocol::ChannelRow& row) { return protocol::valid(row); });
}

}  // namespace stilt::hal
