#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <thread>

#include "firmware/realtime/system_call_guard.h"
#include "firmware/realtime/thread.h"
#include "hal/can/fdcanusb/fdcanusb_bus.h"
#include "hal/robot/clock.h"
#include "tests/hal/can/fdcanusb/adapter_emulator.h"

// A torque loop under the system-call guard over an adapter at a serial port. In a process of its own: a
// guard is never taken off.
namespace stilt::realtime {
namespace {

constexpr std::int64_t kTick_ns = 1'000'000;
constexpr int kMostTicks = 20'000;

struct Scene {
  hal::fdcanusb::AdapterEmulator adapter;
  hal::fdcanusb::FdcanusbBus bus;
  std::atomic<bool> done = false;
  std::atomic<bool> unplug = false;
};

/// Sends until the adapter has answered, loses it, and gets it back.
void run_torque_loop(void* context) {
  if (!forbid_other_system_calls()) std::_Exit(5);
  auto& scene = *static_cast<Scene*>(context);
  hal::MonotonicClock clock;
  hal::FrameBus& bus = scene.bus.frames();
  std::array<hal::CanFrame, 4> received;
  const hal::CanFrame command = hal::classic_frame(1, 8);
  for (int tick = 0; tick < kMostTicks && !scene.done; ++tick) {
    static_cast<void>(clock.sleep_until(clock.now_ns() + kTick_ns));
    static_cast<void>(bus.receive(received));
    const hal::BusStatus status = bus.send(std::span(&command, 1)).status;
    bus.clear_bus_off();
    if (bus.counters().confirmed > 0) scene.unplug = true;
    if (status == hal::BusStatus::disconnected && scene.bus.reconnect()) scene.done = true;
  }
}

[[noreturn]] void lose_and_restore() {
  Scene scene;
  std::atomic<bool> opened = false;
  std::thread host([&] {
    while (!opened) scene.adapter.serve();
  });
  hal::fdcanusb::AdapterOptions options;
  options.stale_ns = options.answer_timeout_ns = std::numeric_limits<std::int64_t>::max() / 2;
  const bool open = scene.bus.open(scene.adapter.path(), options).has_value();
  opened = true;
  host.join();
  if (!open) std::_Exit(4);
  Thread torque_loop;
  if (!torque_loop.start({"guarded"}, run_torque_loop, &scene)) std::_Exit(6);
  bool replugged = false;
  hal::MonotonicClock clock;
  for (int turn = 0; turn < kMostTicks && !scene.done; ++turn) {
    scene.adapter.serve();
    if (scene.unplug && !replugged) {
      scene.adapter.unplug();
      static_cast<void>(clock.sleep_until(clock.now_ns() + kTick_ns));
      scene.adapter.plug_in();
      replugged = true;
    }
  }
  std::_Exit(scene.done ? 0 : 7);
}

TEST(AdapterCalls, ATorqueLoopUnderTheGuardSendsOverAnAdapterAndGetsItBack) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers use system calls of their own";
#endif
  EXPECT_EXIT(lose_and_restore(), ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace stilt::realtime
