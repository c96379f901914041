#include <array>
#include <set>
#include <string>
#include <utility>

#include "firmware/configuration/channel_text.h"
#include "firmware/configuration/hardware_consistency.h"
#include "hal/robot/wiring_load.h"

namespace stilt::configuration {
namespace {

using hal::BaseChannel;

/// A driver, or a frame of the torso sensor, as people know it.
struct Node {
  std::string_view name;
  std::string_view key;  ///< where its identifier stands
  int bus = 0;
  hal::NodeIdentifiers identifiers;
};

struct ChannelKey {
  std::string_view name;
  std::string TorsoSensorParameters::*text;
};
constexpr ChannelKey kChannels[] = {
    {"torso_sensor.pitch", &TorsoSensorParameters::pitch},
    {"torso_sensor.pitch_rate", &TorsoSensorParameters::pitch_rate},
    {"torso_sensor.acceleration_x", &TorsoSensorParameters::acceleration_x},
    {"torso_sensor.acceleration_z", &TorsoSensorParameters::acceleration_z},
    {"torso_sensor.left_foot_force", &TorsoSensorParameters::left_foot_force},
    {"torso_sensor.right_foot_force", &TorsoSensorParameters::right_foot_force},
    {"torso_sensor.emergency_stop_released", &TorsoSensorParameters::emergency_stop_released}};

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

/// One a frame, named by its first channel.
std::vector<Node> sensor_frames(const TorsoSensorParameters& sensor) {
  std::vector<Node> nodes;
  std::set<std::pair<std::uint32_t, bool>> seen;
  for (const ChannelKey& channel : kChannels) {
    const auto row = parse_channel(sensor.*channel.text, BaseChannel::pitch_rad);
    if (!row || !*row || !seen.emplace((*row)->id, (*row)->extended).second) continue;
    nodes.push_back({channel.name, channel.name, sensor.bus, hal::identifiers(**row)});
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

}  // namespace

void check_identifiers(const HardwareParameters& hardware, std::vector<Contradiction>& found) {
  const std::vector<Node> joints = drivers(hardware);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) compare(joints[j], joints[i], found);
    for (const Node& frame : sensor_frames(hardware.torso_sensor)) compare(joints[i], frame, found);
  }
}

}  // namespace stilt::configuration
