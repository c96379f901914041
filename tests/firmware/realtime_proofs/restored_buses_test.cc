#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <string>

#include "firmware/realtime/system_call_guard.h"
#include "firmware/realtime/thread.h"
#include "hal/any_bus.h"
#include "hal/loopback/loopback_server.h"
#include "hal/robot/clock.h"
#include "hal/robot/robot_hardware.h"

// A torque loop under the system-call guard loses its bus and gets it back. In a process of its own: a guard
// is never taken off.
namespace stilt::realtime {
namespace {

constexpr std::int64_t kTick_ns = 1'000'000;
constexpr int kMostTicks = 20'000;

/// One loopback bus with both its ends, and the hardware over it.
struct Scene {
  hal::loopback::LoopbackServer server;
  hal::AnyBus bus;
  hal::RobotWiring wiring;
  std::optional<hal::RobotHardware> hardware;
  std::atomic<bool> lost = false;
  std::atomic<bool> done = false;
  bool helped = true;  ///< somebody else connects again

  Scene() {
    const std::string name = "restored_buses_" + std::to_string(::getpid());
    if (!server.open(name)) std::_Exit(3);
    std::atomic<bool> connected = false;
    Thread host;
    struct Host {
      hal::loopback::LoopbackServer& server;
      std::atomic<bool>& connected;
    } context{server, connected};
    static_cast<void>(host.start(
        {"host"},
        [](void* into) {
          auto& at = *static_cast<Host*>(into);
          while (!at.connected.load()) serve(at.server);
        },
        &context));
    const bool open = bus.open("loopback:" + name, {}).has_value();
    connected = true;
    host.join();
    if (!open) std::_Exit(4);
    for (std::uint16_t joint = 0; joint < hal::kJoints; ++joint) {
      wiring.joints[joint].driver = hal::mit::MitDriver{.command_id = joint};
    }
    const std::array<hal::FrameBus*, 1> buses{&bus.frames()};
    hardware.emplace(wiring, hal::BringUpOptions{}, buses);
  }

  static void serve(hal::loopback::LoopbackServer& server) {
    std::array<hal::CanFrame, hal::kMaximumBatch> frames;
    static_cast<void>(server.receive(frames));
  }
};

void run_torque_loop(void* context) {
  if (!forbid_other_system_calls()) std::_Exit(5);
  auto& scene = *static_cast<Scene*>(context);
  hal::MonotonicClock clock;
  hal::RobotReadings readings;
  for (int tick = 0; tick < kMostTicks; ++tick) {
    const std::int64_t now_ns = clock.sleep_until(clock.now_ns() + kTick_ns);
    scene.hardware->read(now_ns, readings);
    const bool gone = readings.status == hal::JointBusStatus::disconnected;
    if (scene.lost && !gone) {
      scene.done = true;
      return;
    }
    scene.lost = scene.lost || gone;
    if (gone && scene.helped) scene.hardware->restore_buses();
    if (gone && !scene.helped) static_cast<void>(scene.bus.reconnect());
  }
}

[[noreturn]] void lose_and_restore(bool helped) {
  Scene scene;
  scene.helped = helped;
  Thread torque_loop;
  if (!torque_loop.start({"guarded"}, run_torque_loop, &scene)) std::_Exit(6);
  scene.server.hang_up();
  hal::MonotonicClock clock;
  for (int turn = 0; turn < kMostTicks && !scene.done; ++turn) {
    Scene::serve(scene.server);
    scene.hardware->serve_restore([&scene](std::size_t) { static_cast<void>(scene.bus.reconnect()); });
    static_cast<void>(clock.sleep_until(clock.now_ns() + kTick_ns));
  }
  std::_Exit(scene.done ? 0 : 7);
}

class RestoredBuses : public ::testing::Test {
 protected:
  void SetUp() override {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers use system calls of their own";
#endif
  }
};

TEST_F(RestoredBuses, ATorqueLoopUnderTheGuardGetsItsBusBack) {
  EXPECT_EXIT(lose_and_restore(true), ::testing::ExitedWithCode(0), "");
}

TEST_F(RestoredBuses, ConnectingByItselfWouldBreakTheGuard) {
  EXPECT_EXIT(lose_and_restore(false), ::testing::KilledBySignal(SIGSYS), "");
}

}  // namespace
}  // namespace stilt::realtime
