#include "hal/robot/robot_hardware.h"

#include <algorithm>

namespace stilt::hal {
namespace {

using BusPointers = std::array<FrameBus*, kMaximumBuses>;

/// Puts the taps before the buses.
BusPointers tapped(const RobotWiring& wiring, std::span<TapBus> taps,
                   std::span<FrameBus* const> buses) noexcept {
  BusPointers pointers{};
  for (std::size_t bus = 0; bus < buses.size(); ++bus) {
    taps[bus].attach(*buses[bus], FlexibleFrames(wiring, bus));
    pointers[bus] = &taps[bus];
  }
  return pointers;
}

}  // namespace

RobotHardware::RobotHardware(const RobotWiring& wiring, const BringUpOptions& options,
                             std::span<FrameBus* const> buses) noexcept
    : bus_count_(std::min(buses.size(), kMaximumBuses)),
      tap_pointers_(tapped(wiring, taps_, buses.first(bus_count_))),
      robot_(wiring, std::span(tap_pointers_).first(bus_count_)),
      drivers_(wiring, options, std::span(taps_).first(bus_count_), robot_) {}

std::uint64_t RobotHardware::errors(std::size_t bus) const noexcept {
  const BusCounters& counters = taps_[bus].counters();
  return counters.dropped_full + counters.withheld + counters.dropped_received + counters.malformed +
         counters.error_frames;
}

std::uint64_t RobotHardware::errors() const noexcept {
  std::uint64_t count = 0;
  for (std::size_t bus = 0; bus < bus_count_; ++bus) count += errors(bus);
  return count;
}

BusStates RobotHardware::bus_states() noexcept {
  BusStates states;
  for (std::size_t bus = 0; bus < bus_count_; ++bus) {
    const auto bit = static_cast<std::uint8_t>(1u << bus);
    if (taps_[bus].health() == BusHealth::off) states.off |= bit;
    if (taps_[bus].disconnected()) states.gone |= bit;
    const std::uint64_t count = errors(bus);
    if (count > errors_before_[bus]) states.erring |= bit;
    errors_before_[bus] = count;
  }
  return states;
}

void RobotHardware::read(std::int64_t now_ns, RobotReadings& readings) noexcept {
  readings.status = robot_.read(now_ns, readings.joints);
  drivers_.watch();
  static_cast<void>(robot_.read_base(readings.base));  // its age is in the reading
  robot_.serve_torso_sensor(now_ns);
  readings.emergency_stop = robot_.read_emergency_stop(now_ns);
  readings.bus_errors = errors();
  readings.buses = bus_states();
}

void RobotHardware::restore_buses() noexcept {
  for (TapBus& tap : buses()) tap.clear_bus_off();  // first: it may be what withholds the next frames
  robot_.clear_faults();
  for (TapBus& tap : buses()) tap.begin_reconnect();
}

}  // namespace stilt::hal
