#include "hal/robot/robot_wiring.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace stilt::hal {
namespace {

bool valid_driver(const JointWiring& joint) noexcept {
  return visit_driver(joint.driver, [](const auto& driver) { return valid(driver); });
}

/// Equal means the same driver.
bool same_driver(const JointWiring& a, const JointWiring& b) noexcept {
  const auto address_of = [](const JointWiring& joint) {
    return visit_driver(joint.driver, [](const auto& driver) { return address(driver); });
  };
  return a.bus == b.bus && a.driver.index() == b.driver.index() && address_of(a) == address_of(b);
}

}  // namespace

int extra_encoder_of(const JointWiring& joint) noexcept {
  return visit_driver(joint.driver, [](const auto& driver) { return extra_encoder(driver); });
}

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
      if (same_driver(wiring.joints[j], joint)) return false;
    }
  }
  if (wiring.pitch_encoder_joint >= 0) {
    const JointWiring& joint = wiring.joints[static_cast<std::size_t>(wiring.pitch_encoder_joint)];
    if (extra_encoder_of(joint) < 0) return false;
  }
  const auto rows = std::span(wiring.channels).first(wiring.channel_count);
  return std::abs(wiring.pitch_direction) == 1 && std::isfinite(wiring.pitch_offset_rad) &&
         std::all_of(rows.begin(), rows.end(), [](const ChannelRow& row) { return valid(row); });
}

}  // namespace stilt::hal
