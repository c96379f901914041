#include "firmware/open_buses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>

#include "hal/can/lockstep.h"
#include "hal/robot/wiring_load.h"

namespace stilt {

hal::socketcan::BusOptions bus_options(const configuration::HardwareParameters& hardware, std::size_t bus,
                                       bool lockstep) {
  const hal::RobotWiring wiring = configuration::robot_wiring(hardware);
  hal::socketcan::BusOptions options;
  options.receive_ids = hal::receive_ids(wiring, bus);
  options.fd = hal::uses_fd(wiring, bus);
  options.bit_rate_bit_s = std::lround(hardware.bit_rate_bit_s);
  options.data_bit_rate_bit_s = std::lround(hardware.data_bit_rate_bit_s);
  if (lockstep) {
    options.receive_ids.push_back({hal::kControllerSyncId, true});
    options.receive_ids.push_back({hal::kRobotSyncId, true});
  }
  return options;
}

std::expected<std::vector<hal::AnyBus>, std::string> open_buses(
    const configuration::HardwareParameters& hardware, bool lockstep, Received received, int priority) {
  const std::vector<std::string> names = configuration::bus_names(hardware);
  std::vector<hal::AnyBus> buses(names.size());
  for (std::size_t bus = 0; bus < names.size(); ++bus) {
    if (const auto locked = buses[bus].lock(names[bus]); !locked) return std::unexpected(locked.error());
    hal::socketcan::BusOptions options = bus_options(hardware, bus, lockstep);
    if (received == Received::all) options.receive_ids.clear();
    const auto opened = buses[bus].open(names[bus], options, priority);
    if (!opened) return std::unexpected(opened.error());
  }
  return buses;
}

std::string unacknowledged_sentence(const std::string& bus, std::size_t commands) {
  const std::string what = commands == 1 ? "a command" : std::to_string(commands) + " commands";
  std::string sentence = "bus " + bus + ": no driver has acknowledged " + what +
                         "; drivers get such a command when motor power returns, without stiltd";
  if (bus.starts_with(hal::loopback::kPrefix)) return sentence;
  return sentence + "; before that: `ip link set " + bus + " down && ip link set " + bus + " up`";
}

std::vector<std::string> unacknowledged(std::vector<hal::AnyBus>& buses) {
  constexpr int kSteps = 50;
  constexpr timespec kStep{.tv_sec = 0, .tv_nsec = 1'000'000};
  std::array<hal::CanFrame, hal::kMaximumBatch> ignored;
  const auto waits = [&ignored](hal::AnyBus& bus) {
    while (bus.frames().receive(ignored).status == hal::BusStatus::more) {
    }
    return bus.unconfirmed() > 0;
  };
  for (int step = 0; step < kSteps && std::ranges::any_of(buses, waits); ++step) nanosleep(&kStep, nullptr);
  std::vector<std::string> sentences;
  for (hal::AnyBus& bus : buses) {
    if (bus.unconfirmed() > 0) sentences.push_back(unacknowledged_sentence(bus.name(), bus.unconfirmed()));
  }
  return sentences;
}

}  // namespace stilt
