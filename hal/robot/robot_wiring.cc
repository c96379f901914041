#include "hal/robot/robot_wiring.h"

#include <algorithm>
#include <cmath>
#include <numbers>
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

bool valid_torso_sensor(const RobotWiring& wiring, std::size_t bus_count) noexcept {
  if (wiring.pitch_encoder_joint >= static_cast<int>(kJoints)) return false;
  if (wiring.pitch_encoder_joint >= 0) {
    const JointWiring& joint = wiring.joints[static_cast<std::size_t>(wiring.pitch_encoder_joint)];
    if (extra_encoder_of(joint) < 0 || wiring.pitch_encoder || wiring.serial_imu) return false;
  }
  if (wiring.pitch_encoder && wiring.serial_imu) return false;
  if (wiring.pitch_encoder && (wiring.pitch_encoder_bus >= bus_count || !valid(*wiring.pitch_encoder)))
    return false;
  const auto rows = std::span(wiring.channels).first(wiring.channel_count);
  return wiring.channel_period_ticks >= 1 && wiring.channel_pitch_period_rad >= 0 &&
         std::abs(wiring.pitch_direction) == 1 && std::isfinite(wiring.pitch_offset_rad) &&
         std::isfinite(wiring.pitch_ratio) && wiring.pitch_ratio > 0 &&
         std::all_of(rows.begin(), rows.end(), [](const ChannelRow& row) { return valid(row); });
}

}  // namespace

bool reports_by_itself(const JointDriver& driver) noexcept {
  return visit_driver(driver, [](const auto& any) { return report_rate_hz(any); }) > 0;
}

int report_period_ticks(const JointDriver& driver, double tick_hz) noexcept {
  constexpr double kRounding = 1e-9;
  const double rate_hz = visit_driver(driver, [](const auto& any) { return report_rate_hz(any); });
  return rate_hz > 0 ? static_cast<int>(std::ceil(tick_hz / rate_hz - kRounding)) + 1 : 1;
}

int extra_encoder_of(const JointWiring& joint) noexcept {
  return visit_driver(joint.driver, [](const auto& driver) { return extra_encoder(driver); });
}

bool pitch_is_channel(const RobotWiring& wiring) noexcept {
  return wiring.pitch_encoder_joint < 0 && !wiring.pitch_encoder && !wiring.serial_imu;
}

TorsoSensorTraits torso_sensor_traits(const RobotWiring& wiring) noexcept {
  constexpr double kTurn_rad = 2 * std::numbers::pi;
  TorsoSensorTraits traits;
  traits.rate_window_s = wiring.rate_window_s;
  if (wiring.pitch_encoder_joint >= 0) {  // with every reply
    traits.pitch_period_rad = kTurn_rad / wiring.pitch_ratio;
    return traits;
  }
  traits.period_reads = static_cast<std::uint32_t>(wiring.channel_period_ticks);
  if (wiring.pitch_encoder) {
    traits.has_rate = wiring.pitch_encoder->speed_rad_s != 0;
    traits.pitch_period_rad = kTurn_rad * wiring.pitch_encoder->turns / wiring.pitch_ratio;
    return traits;
  }
  if (wiring.serial_imu) {
    if (wiring.serial_imu->by_roll) traits.pitch_period_rad = kTurn_rad;
    return traits;
  }
  traits.pitch_period_rad = wiring.channel_pitch_period_rad;
  const auto rows = std::span(wiring.channels).first(wiring.channel_count);
  traits.has_rate = std::any_of(rows.begin(), rows.end(), [](const ChannelRow& row) {
    return row.channel == BaseChannel::pitch_rate_rad_s;
  });
  return traits;
}

bool valid(const RobotWiring& wiring, std::size_t bus_count) noexcept {
  if (bus_count == 0 || bus_count > kMaximumBuses || wiring.channel_count > kMaximumChannels ||
      wiring.channel_bus >= bus_count) {
    return false;
  }
  for (std::size_t i = 0; i < kJoints; ++i) {
    const JointWiring& joint = wiring.joints[i];
    if (joint.bus >= bus_count || std::abs(joint.direction) != 1 || !(joint.ratio > 0) ||
        !std::isfinite(joint.ratio) || !std::isfinite(joint.offset_rad) || !(joint.torque_factor > 0) ||
        !std::isfinite(joint.torque_factor) || joint.report_period_ticks < 1 || !valid_driver(joint)) {
      return false;
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (same_driver(wiring.joints[j], joint)) return false;
    }
  }
  return valid_torso_sensor(wiring, bus_count);
}

}  // namespace stilt::hal
