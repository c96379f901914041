#pragma once

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "hal/can/fdcanusb/fdcanusb_bus.h"
#include "tests/hal/can/fdcanusb/adapter_emulator.h"

namespace stilt::hal::fdcanusb {

/// An emulated adapter and a bus over it. The test's thread is the torque loop and serves the adapter, too.
class AdapterRig : public testing::Test {
 protected:
  /// No frame and no answer is ever too old: how fast a test runs decides nothing.
  static AdapterOptions patient() {
    AdapterOptions options;
    options.stale_ns = std::numeric_limits<std::int64_t>::max() / 2;
    options.answer_timeout_ns = options.stale_ns;
    options.open_timeout_ns = kLongest.count();
    return options;
  }

  /// Opens a bus while another thread serves the adapter.
  std::string open(FdcanusbBus& bus, const AdapterOptions& options = patient()) {
    std::atomic<bool> done = false;
    std::thread adapter([&] {
      while (!done) emulator.serve();
    });
    const auto opened = bus.open(emulator.path(), options);
    done = true;
    adapter.join();
    return opened ? "" : opened.error();
  }

  /// Serves the adapter until something is so. False: it never was.
  template <class Condition>
  [[nodiscard]] bool until(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + kLongest;
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      emulator.serve();
    }
    return true;
  }

  static std::vector<CanFrame> receive_all(FrameBus& bus) {
    std::array<CanFrame, kMaximumBatch> frames;
    std::vector<CanFrame> all;
    while (true) {
      const ReceiveResult result = bus.receive(frames);
      all.insert(all.end(), frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(result.received));
      if (result.status != BusStatus::more) return all;
    }
  }

  /// Counters that a call has brought up to date.
  static BusCounters counters(FrameBus& bus) {
    static_cast<void>(bus.send({}));
    return bus.counters();
  }

  static constexpr std::chrono::nanoseconds kLongest = std::chrono::seconds(30);  // a bound for hanging
  AdapterEmulator emulator;
};

}  // namespace stilt::hal::fdcanusb
