#include "firmware/program/self_test.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "firmware/hardware/round_trip.h"
#include "firmware/realtime/pace.h"
#include "firmware/realtime/thread.h"
#include "hal/clock.h"

namespace stilt::program {
namespace {

constexpr const char* kJoints[] = {"hip_L", "knee_L", "hip_R", "knee_R"};
constexpr double kEnoughReplies = 0.999;
constexpr long long kBringUpTicks = 5000;
/// Share of a tick in which replies must come.
constexpr double kReplyShare = 0.8;

/// The test on a thread like the torque loop's.
struct Test {
  Test(const Options& asked, ControllerState& controller, const std::atomic<bool>& end)
      : options(asked), state(controller), stop(end) {}

  const Options& options;
  ControllerState& state;
  const std::atomic<bool>& stop;
  SelfTestFigures figures;
  hal::MonotonicClock clock;
  hal::JointReadings readings;
};

/// One tick: sleeps, reads. Returns its time.
std::int64_t begin_tick(Test& test, realtime::Pace& pace) {
  const std::int64_t now_ns = test.clock.sleep_until(pace.next_ns());
  test.figures.wakeup.add_ns(now_ns - pace.next_ns());
  static_cast<void>(test.state.hardware->robot().read(now_ns, test.readings));
  return now_ns;
}

bool bring_up(Test& test, realtime::Pace& pace) {
  hardware::CanDrivers& drivers = test.state.hardware->drivers();
  drivers.begin();
  hardware::DriversProgress progress;
  for (long long tick = 0; tick < kBringUpTicks && !progress.ready && !progress.failed; ++tick) {
    progress = drivers.step(begin_tick(test, pace));
    pace.advance(test.clock.now_ns());
  }
  if (progress.ready) return true;
  test.figures.failure = std::string("the driver of ") + kJoints[progress.joint] +
                         " cannot be brought up: " + hal::bring_up::name(progress.failure);
  return false;
}

void count(Test& test) {
  SelfTestFigures& figures = test.figures;
  ++figures.ticks;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    if (test.readings[joint].missed == 0) ++figures.replies[joint];
  }
  hal::BaseReading base;
  if (test.state.hardware->robot().read_base(base) == hal::BaseSensorStatus::ok) ++figures.base_readings;
}

void run(void* context) {
  Test& test = *static_cast<Test*>(context);
  hardware::RobotHardware& hardware = *test.state.hardware;
  const auto tick_ns = std::llround(1e9 / test.options.configuration.timing.torque_rate_hz);
  realtime::Pace pace(test.clock.now_ns() + tick_ns, tick_ns);
  hardware::RoundTrip round_trip(configuration::robot_wiring(test.options.configuration.hardware),
                                 hardware.buses());
  if (bring_up(test, pace)) {
    const long long ticks = std::llround(test.options.self_test_s * 1e9 / static_cast<double>(tick_ns));
    const std::uint64_t errors = hardware.errors();
    for (long long tick = -1; tick < ticks && !test.stop.load(); ++tick) {
      static_cast<void>(begin_tick(test, pace));
      if (tick >= 0) count(test);  // the first command has no predecessor
      static_cast<void>(hardware.robot().write({}));
      const std::int64_t sent_ns = test.clock.now_ns();
      const auto wait_ns = std::llround(kReplyShare * static_cast<double>(tick_ns));
      const std::int64_t took_ns = round_trip.measure(test.clock, sent_ns, pace.next_ns() + wait_ns);
      if (took_ns >= 0) test.figures.round_trip.add_ns(took_ns);
      pace.advance(test.clock.now_ns());
      for (hardware::TapBus& bus : hardware.buses()) bus.forget();
    }
    test.figures.bus_errors = static_cast<long long>(hardware.errors() - errors);
  }
  static_cast<void>(hardware.robot().disable());
}

double share(long long part, long long whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

std::string line(const char* name, const diagnostics::Percentiles& time_us) {
  char text[120];
  std::snprintf(text, sizeof text, "%-14s p50 %.0f, p99 %.0f, max %.0f us\n", name, time_us.p50_us,
                time_us.p99_us, time_us.max_us);
  return text;
}

}  // namespace

bool SelfTestFigures::passed() const noexcept {
  return failure.empty() && ticks > 0 && std::ranges::all_of(replies, [this](long long of_joint) {
           return share(of_joint, ticks) >= kEnoughReplies;
         });
}

SelfTestFigures run_self_test(const Options& options, ControllerState& state, const std::atomic<bool>& stop) {
  Test test(options, state, stop);
  const configuration::RuntimeParameters& runtime = options.configuration.runtime;
  realtime::Thread thread;
  if (!thread.start({"self-test", runtime.torque_priority, runtime.torque_core}, run, &test)) {
    test.figures.failure = "no thread can be started";
  }
  thread.join();
  return test.figures;
}

std::string to_text(const SelfTestFigures& figures) {
  if (!figures.failure.empty()) return figures.failure + '\n';
  std::string text;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    char replies[120];
    std::snprintf(replies, sizeof replies, "%-14s %.2f %% of %lld commands answered\n", kJoints[joint],
                  100 * share(figures.replies[joint], figures.ticks), figures.ticks);
    text += replies;
  }
  text += "base sensor    " + std::to_string(figures.base_readings) + " readings\n";
  text += "bus errors     " + std::to_string(figures.bus_errors) + '\n';
  text += line("round trip", figures.round_trip.percentiles());
  text += line("wake-up", figures.wakeup.percentiles());
  return text + (figures.passed() ? "passed\n" : "failed: each joint must answer 99.9 % of its commands\n");
}

std::string to_json(const SelfTestFigures& figures) {
  const auto percentiles = [](const diagnostics::Histogram& histogram) {
    const diagnostics::Percentiles time_us = histogram.percentiles();
    return nlohmann::ordered_json{{"p50", time_us.p50_us}, {"p99", time_us.p99_us}, {"max", time_us.max_us}};
  };
  nlohmann::ordered_json json;
  json["passed"] = figures.passed();
  if (!figures.failure.empty()) json["failure"] = figures.failure;
  json["commands"] = figures.ticks;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    json["reply_share"][kJoints[joint]] = share(figures.replies[joint], figures.ticks);
  }
  json["base_readings"] = figures.base_readings;
  json["bus_errors"] = figures.bus_errors;
  json["bus_round_trip_us"] = percentiles(figures.round_trip);
  json["wakeup_us"] = percentiles(figures.wakeup);
  return json.dump(2) + "\n";
}

}  // namespace stilt::program
