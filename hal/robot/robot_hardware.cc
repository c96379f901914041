#include "hal/robot/robot_hardware.h"

#include <algorithm>

namespace stilt::hal {
namespace {

using BusPointers = std::array<FrameBus*, kMaximumBuses>;

/// Puts the taps before the buses.
BusPointers tapped(std::span<TapBus> taps, std::span<FrameBus* const> buses) noexcept {
  BusPointers pointers{};
  for (std::size_t bus = 0; bus < buses.size(); ++bus) {
    taps[bus].attach(*buses[bus]);
    pointers[bus] = &taps[bus];
  }
  return pointers;
}

}  // namespace

RobotHardware::RobotHardware(const RobotWiring& wiring, const BringUpOptions& options,
                             std::span<FrameBus* const> buses) noexcept
    : bus_count_(std::min(buses.size(), kMaximumBuses)),
      tap_pointers_(tapped(taps_, buses.first(bus_count_))),
      robot_(wiring, std::span(tap_pointers_).first(bus_count_)),
      drivers_(wiring, options, std::span(taps_).first(bus_count_), robot_) {}

std::uint64_t RobotHardware::errors() const noexcept {
  std::uint64_t count = 0;
  for (const TapBus& tap : std::span(taps_).first(bus_count_)) {
    const BusCounters& counters = tap.counters();
    count += counters.dropped_full + counters.withheld + counters.dropped_received + counters.malformed +
             counters.error_frames;
  }
  return count;
}

void RobotHardware::read(std::int64_t now_ns, RobotReadings& readings) noexcept {
  readings.status = robot_.read(now_ns, readings.joints);
  static_cast<void>(robot_.read_base(readings.base));  // its age is in the reading
  robot_.serve_torso_sensor(now_ns);
  readings.emergency_stop = robot_.read_emergency_stop(now_ns);
  readings.bus_errors = errors();
}

void RobotHardware::restore_buses() noexcept {
  for (TapBus& tap : buses()) tap.clear_bus_off();  // first: it may be what withholds the next frames
  robot_.clear_faults();
  for (TapBus& tap : buses()) tap.begin_reconnect();
}

}  // namespace stilt::hal
