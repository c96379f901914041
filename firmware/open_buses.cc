#include "firmware/open_buses.h"

#include "hal/can/lockstep.h"
#include "hal/robot/wiring_load.h"

namespace stilt {

hal::socketcan::BusOptions bus_options(const hal::RobotWiring& wiring, std::size_t bus, bool lockstep) {
  hal::socketcan::BusOptions options;
  options.receive_ids = hal::receive_ids(wiring, bus);
  options.fd = hal::uses_fd(wiring, bus);
  if (lockstep) {
    options.receive_ids.push_back({hal::kControllerSyncId, true});
    options.receive_ids.push_back({hal::kRobotSyncId, true});
  }
  return options;
}

std::expected<std::vector<hal::AnyBus>, std::string> open_buses(
    const configuration::HardwareParameters& hardware, bool lockstep, Received received, int priority) {
  const hal::RobotWiring wiring = configuration::robot_wiring(hardware);
  const std::vector<std::string> names = configuration::bus_names(hardware);
  std::vector<hal::AnyBus> buses(names.size());
  for (std::size_t bus = 0; bus < names.size(); ++bus) {
    if (const auto locked = buses[bus].lock(names[bus]); !locked) return std::unexpected(locked.error());
    hal::socketcan::BusOptions options = bus_options(wiring, bus, lockstep);
    if (received == Received::all) options.receive_ids.clear();
    const auto opened = buses[bus].open(names[bus], options, priority);
    if (!opened) return std::unexpected(opened.error());
  }
  return buses;
}

}  // namespace stilt
