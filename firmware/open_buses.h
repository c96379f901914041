#pragma once

#include <cstddef>
#include <expected>
#include <string>
#include <vector>

#include "firmware/configuration/hardware.h"
#include "hal/any_bus.h"

namespace stilt {

/// Identifiers that come in from a bus.
enum class Received { those_of_the_wiring, all };

/// Opens the buses of a configuration, in the order of their numbers, and takes the right to command them.
/// Beside main, the only place of the controller that depends on what carries its frames. The error is one
/// sentence for the user. Start-up only.
/// @param lockstep  also lets the sync frames of a simulated robot through
/// @param priority  SCHED_FIFO of the threads that some buses have; 0: ordinary
[[nodiscard]] std::expected<std::vector<hal::AnyBus>, std::string> open_buses(
    const configuration::HardwareParameters& hardware, bool lockstep,
    Received received = Received::those_of_the_wiring, int priority = 0);

/// Waits up to 50 ms for the last commands to be seen on their buses. One sentence for each bus where a
/// command is not. Its controller repeats the command until a driver has power again, also after the end of
/// stiltd. After the last tick, never in real time.
[[nodiscard]] std::vector<std::string> unacknowledged(std::vector<hal::AnyBus>& buses);
[[nodiscard]] std::string unacknowledged_sentence(const std::string& bus, std::size_t commands);

/// What a bus receives: replies, echoes of our own commands, sensors.
[[nodiscard]] hal::socketcan::BusOptions bus_options(const configuration::HardwareParameters& hardware,
                                                     std::size_t bus, bool lockstep);

}  // namespace stilt
