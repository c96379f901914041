#include "firmware/open_buses.h"

#include <span>
#include <utility>

#include "hal/can/lockstep.h"
#include "hal/mit/damiao_registers.h"

namespace stilt {
namespace {

using hal::socketcan::BusOptions;

void add_mit(const hal::protocol::MitDriver& driver, BusOptions& options) {
  options.receive_ids.push_back({driver.command_id, false});
  options.receive_ids.push_back({driver.reply_id, false});
  if (driver.layout == hal::protocol::ReplyLayout::damiao) {
    options.receive_ids.push_back({hal::protocol::kDamiaoRegisterId, false});
  }
}

/// Identifier = source << 8 | destination, the top bit asks for a reply (hal/moteus/moteus.h).
void add_moteus(const hal::protocol::MoteusDriver& driver, BusOptions& options) {
  const std::uint32_t reply = static_cast<std::uint32_t>(driver.id) << 8 | driver.source;
  const std::uint32_t command = static_cast<std::uint32_t>(driver.source) << 8 | driver.id;
  options.receive_ids.push_back({reply, reply > hal::kMaximumStandardId});
  options.receive_ids.push_back({0x8000u | command, true});
  options.fd = true;
}

/// Every command of the node, both ways.
void add_odrive(std::uint8_t node, BusOptions& options) {
  for (std::uint32_t command = 0; command < 32; ++command) {
    options.receive_ids.push_back({static_cast<std::uint32_t>(node) << 5 | command, false});
  }
}

}  // namespace

BusOptions bus_options(const hal::RobotWiring& wiring, std::size_t bus, bool lockstep) {
  BusOptions options;
  for (const hal::JointWiring& joint : wiring.joints) {
    if (joint.bus != bus) continue;
    if (const auto* mit = std::get_if<hal::protocol::MitDriver>(&joint.driver)) {
      add_mit(*mit, options);
    } else if (const auto* moteus = std::get_if<hal::protocol::MoteusDriver>(&joint.driver)) {
      add_moteus(*moteus, options);
    } else {
      add_odrive(std::get<hal::OdriveNode>(joint.driver).node, options);
    }
  }
  if (wiring.channel_bus == bus) {
    for (const auto& row : std::span(wiring.channels).first(wiring.channel_count)) {
      options.receive_ids.push_back({row.id, row.extended});
    }
  }
  if (lockstep) {
    options.receive_ids.push_back({hal::protocol::kControllerSyncId, true});
    options.receive_ids.push_back({hal::protocol::kRobotSyncId, true});
  }
  return options;
}

std::expected<std::vector<hal::AnyBus>, std::string> open_buses(
    const configuration::HardwareParameters& hardware, bool lockstep) {
  const hal::RobotWiring wiring = configuration::robot_wiring(hardware);
  const std::vector<std::string> names = configuration::bus_names(hardware);
  std::vector<hal::AnyBus> buses(names.size());
  for (std::size_t bus = 0; bus < names.size(); ++bus) {
    const auto opened = buses[bus].open(names[bus], bus_options(wiring, bus, lockstep));
    if (!opened) return std::unexpected(opened.error());
  }
  return buses;
}

}  // namespace stilt
