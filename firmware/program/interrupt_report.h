#pragma once

#include <string>
#include <vector>

#include "firmware/configuration/runtime.h"
#include "firmware/realtime/bus_interrupts.h"

namespace stilt::program {

/// Of the threads that serve buses, those that may run on the planner's processor and wait there for a solve.
/// ksoftirqd is none of them: what an interrupt thread raises, that thread works off itself.
[[nodiscard]] std::vector<realtime::InterruptThread> delayed_threads(
    const std::vector<realtime::BusInterrupts>& buses, const configuration::RuntimeParameters& runtime);

/// A sentence for each bus with an adapter: "can0 (spi0.0): irq/45-spi0.0 (process 117, priority 50)", or
/// that no thread is known.
[[nodiscard]] std::vector<std::string> interrupt_sentences(const std::vector<realtime::BusInterrupts>& buses);

}  // namespace stilt::program
