#include <array>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "firmware/configuration/hardware_consistency.h"
#include "hal/robot/wiring_load.h"

namespace stilt::configuration {
namespace {

using hal::BaseChannel;

/// A driver, or a frame of the torso sensor, under its name for people.
struct Node {
  std::string_view name;
  std::string_view key;  ///< where its identifier stands
  int bus = 0;
  hal::NodeIdentifiers identifiers;
};

std::string_view key_of(const hal::ChannelRow& row, TorsoDevice device) {
  switch (row.channel) {
    case BaseChannel::pitch_rad:
      return device == TorsoDevice::channels ? "torso_sensor.pitch" : "torso_sensor.device";
    case BaseChannel::pitch_rate_rad_s:
      return device == TorsoDevice::channels ? "torso_sensor.pitch_rate" : "torso_sensor.device";
    case BaseChannel::acceleration_x_m_s2:
      return "torso_sensor.acceleration_x";
    case BaseChannel::acceleration_z_m_s2:
      return "torso_sensor.acceleration_z";
    case BaseChannel::left_foot_force_N:
      return "torso_sensor.left_foot_force";
    case BaseChannel::right_foot_force_N:
      return "torso_sensor.right_foot_force";
    case BaseChannel::emergency_stop_released:
      return "torso_sensor.emergency_stop_released";
  }
  return "torso_sensor.device";
}

std::vector<Node> drivers(const HardwareParameters& hardware) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, hal::kJoints> kNames = {
      {{"hip_L", "hip_L.id"}, {"knee_L", "knee_L.id"}, {"hip_R", "hip_R.id"}, {"knee_R", "knee_R.id"}}};
  const hal::RobotWiring wiring = robot_wiring(hardware);
  std::vector<Node> nodes;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    nodes.push_back({kNames[joint].first, kNames[joint].second, hardware.joint[joint].bus,
                     hal::identifiers(wiring.joints[joint].driver)});
  }
  return nodes;
}

/// One per frame, named by its first channel; and an encoder on CANopen.
std::vector<Node> sensor_nodes(const HardwareParameters& hardware) {
  const TorsoSensorParameters& sensor = hardware.torso_sensor;
  const hal::RobotWiring wiring = robot_wiring(hardware);
  std::vector<Node> nodes;
  std::set<std::pair<std::uint32_t, bool>> seen;
  for (const hal::ChannelRow& row : std::span(wiring.channels).first(wiring.channel_count)) {
    if (!seen.emplace(row.id, row.extended).second) continue;
    const std::string_view key = key_of(row, sensor.device);
    nodes.push_back({key, key, sensor.bus, hal::identifiers(row)});
  }
  if (wiring.pitch_encoder) {
    constexpr std::string_view kKey = "torso_sensor.encoder_node";
    nodes.push_back({kKey, kKey, sensor.bus, hal::canopen::identifiers(*wiring.pitch_encoder)});
  }
  return nodes;
}

/// The later node is the likelier culprit.
void compare(const Node& earlier, const Node& later, std::vector<Contradiction>& found) {
  if (earlier.bus != later.bus) return;
  const auto collisions = hal::collisions(earlier.identifiers, later.identifiers);
  if (collisions.empty()) return;
  found.push_back({{later.key, earlier.key},
                   std::string(later.name) + " and " + std::string(earlier.name) + " are on bus " +
                       std::to_string(later.bus) +
                       " and their frames collide: " + hal::describe(collisions.front().second) +
                       " against " + hal::describe(collisions.front().first) +
                       "; give one of them another identifier or another bus"});
}

/// Channels of one frame: the bits of one would be read as the other, too.
void check_bits(const HardwareParameters& hardware, std::vector<Contradiction>& found) {
  const hal::RobotWiring wiring = robot_wiring(hardware);
  const std::span rows = std::span(wiring.channels).first(wiring.channel_count);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!overlap(rows[j], rows[i])) continue;
      const std::string_view earlier = key_of(rows[j], hardware.torso_sensor.device);
      const std::string_view later = key_of(rows[i], hardware.torso_sensor.device);
      found.push_back({{later, earlier},
                       std::string(later) + " and " + std::string(earlier) +
                           " share bits of a frame; give each the bits that the sensor sends for it"});
    }
  }
}

/// Identifiers of all frames on a bus, each with whether it has 29 bits.
std::set<std::pair<std::uint32_t, bool>> identifiers_on(const hal::RobotWiring& wiring, std::size_t bus) {
  std::set<std::pair<std::uint32_t, bool>> found;
  for (const hal::FrameId& frame : hal::receive_ids(wiring, bus)) found.emplace(frame.id, frame.extended);
  return found;
}

/// "hip_L and knee_L on can0".
std::string drivers_on(const HardwareParameters& hardware, const std::vector<std::string>& buses,
                       std::size_t bus) {
  std::string text;
  for (const Node& joint : drivers(hardware)) {
    if (static_cast<std::size_t>(joint.bus) != bus) continue;
    text += (text.empty() ? "" : " and ") + std::string(joint.name);
  }
  return text + " on " + buses[bus];
}

}  // namespace

std::string exchangeable_buses(const HardwareParameters& hardware) {
  const hal::RobotWiring wiring = robot_wiring(hardware);
  const std::vector<std::string> buses = bus_names(hardware);
  for (std::size_t b = 0; b < buses.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      const auto identifiers = identifiers_on(wiring, a);
      if (identifiers.empty() || identifiers != identifiers_on(wiring, b)) continue;
      return drivers_on(hardware, buses, a) + " have the same identifiers as " +
             drivers_on(hardware, buses, b) +
             ": exchanged adapters would not be noticed; give each driver its own identifier";
    }
  }
  return {};
}

void check_identifiers(const HardwareParameters& hardware, std::vector<Contradiction>& found) {
  const std::vector<Node> joints = drivers(hardware);
  const std::vector<Node> sensors = sensor_nodes(hardware);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) compare(joints[j], joints[i], found);
    for (const Node& sensor : sensors) compare(joints[i], sensor, found);
  }
  check_bits(hardware, found);
  if (!sensors.empty()) {
    for (const Node& frame : std::span(sensors).first(sensors.size() - 1))
      compare(frame, sensors.back(), found);
  }
}

}  // namespace stilt::configuration
