#include "firmware/program/self_test.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "firmware/commissioning/session.h"
#include "firmware/control_loop/joint_names.h"
#include "firmware/program/commissioning_run.h"
#include "hal/robot/clock.h"
#include "hal/robot/round_trip.h"

namespace stilt::program {
namespace {

using control_loop::kJointNames;

/// Share of a tick in which replies must come.
constexpr double kReplyShare = 0.8;

/// The test, and what time is to it.
struct Test {
  Test(const Options& asked, ControllerState& controller, const std::atomic<bool>& end, hal::Clock& time)
      : options(asked),
        state(controller),
        stop(end),
        clock(time),
        replies(hal::reply_frames(configuration::robot_wiring(asked.configuration.hardware))) {
    result.enough_answered = asked.configuration.runtime.self_test_answered_share;
    result.enough_in_time = asked.configuration.runtime.self_test_in_time_share;
  }

  const Options& options;
  ControllerState& state;
  const std::atomic<bool>& stop;
  hal::Clock& clock;
  std::array<hal::ReplyFrame, hal::kJoints> replies;
  SelfTestResult result;
};

/// What came since the last tick. A driver without replies counts by its readings.
void count(Test& test, const hal::RobotReadings& readings, bool base_is_new) {
  SelfTestResult& result = test.result;
  ++result.ticks;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    const hal::ReplyFrame& reply = test.replies[joint];
    const bool in_time = readings.joints[joint].missed_replies == 0;
    if (in_time) ++result.in_time[joint];
    if (!reply.exists && in_time) ++result.answered[joint];
    if (!reply.exists) continue;
    const auto kept = test.state.hardware->buses()[reply.bus].kept();
    result.answered[joint] +=
        std::ranges::count_if(kept, [&reply](const hal::CanFrame& frame) { return reply.is(frame); });
  }
  if (base_is_new) ++result.base_readings;
}

void forget(Test& test) {
  for (hal::TapBus& bus : test.state.hardware->buses()) bus.forget();
}

/// Commands of a joint that never left, since the start: its part of those of its bus, whose joints are
/// commanded together.
long long withheld(Test& test, std::size_t joint) {
  const auto& joints = test.options.configuration.hardware.joint;
  const int bus = joints[joint].bus;
  const hal::BusCounters& counters = test.state.hardware->buses()[static_cast<std::size_t>(bus)].counters();
  const auto together = std::ranges::count(joints, bus, &configuration::JointParameters::bus);
  return static_cast<long long>(counters.withheld + counters.dropped_full) / std::max<long long>(together, 1);
}

/// Commands zero torque, and counts; a last tick without command takes the last replies.
void talk(Test& test, commissioning::Session& session) {
  hal::RobotHardware& hardware = *test.state.hardware;
  hal::RoundTrip round_trip(configuration::robot_wiring(test.options.configuration.hardware),
                            hardware.buses());
  const long long ticks = std::llround(test.options.self_test_s / session.tick_s());
  const std::uint64_t errors = hardware.errors();
  std::array<long long, hal::kJoints> before;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) before[joint] = withheld(test, joint);
  for (long long tick = 0; tick <= ticks; ++tick) {
    const std::int64_t due_ns = session.due_ns();
    const std::int64_t newest_base_ns = session.readings().base.time_ns;
    test.result.wakeup_latency.add_ns(session.begin_tick() - due_ns);
    const bool base_is_new = session.readings().base.time_ns != newest_base_ns;
    if (tick > 0) count(test, session.readings(), base_is_new);  // the first command has no predecessor
    forget(test);
    if (tick == ticks || test.stop.load()) break;
    static_cast<void>(hardware.write({}));
    const std::int64_t sent_ns = test.clock.now_ns();
    const auto wait_ns = std::llround(kReplyShare * static_cast<double>(session.tick_ns()));
    const std::int64_t took_ns =
        test.options.lockstep ? -1 : round_trip.measure(test.clock, sent_ns, due_ns + wait_ns);
    if (took_ns >= 0) test.result.round_trip.add_ns(took_ns);
    session.end_tick();
  }
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    test.result.commands[joint] = test.result.ticks - (withheld(test, joint) - before[joint]);
  }
  test.result.bus_errors = static_cast<long long>(hardware.errors() - errors);
  test.result.last = session.readings();
}

void run(Test& test) {
  const auto tick_ns = std::llround(1e9 / test.options.configuration.timing.torque_rate_hz);
  commissioning::Session session(*test.state.hardware, test.clock, tick_ns, test.stop);
  if (const auto up = session.bring_up()) {
    talk(test, session);
  } else {
    test.result.failure = up.error();
  }
  session.disable();
}

double share(long long part, long long whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

/// "-" for what is not reported.
std::string measured(double value, const char* unit) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3f %s", value, unit);
  return std::isfinite(value) ? text : "-";
}

std::string line(const char* name, const diagnostics::Percentiles& time_us) {
  char text[120];
  std::snprintf(text, sizeof text, "%-14s p50 %.0f, p99 %.0f, max %.0f us\n", name, time_us.p50_us,
                time_us.p99_us, time_us.max_us);
  return text;
}

}  // namespace

bool SelfTestResult::answered_enough() const noexcept {
  if (!failure.empty() || ticks == 0) return false;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    if (share(answered[joint], commands[joint]) < enough_answered) return false;
  }
  return true;
}

bool SelfTestResult::in_time_enough() const noexcept {
  return failure.empty() && ticks > 0 && std::ranges::all_of(in_time, [this](long long of_joint) {
           return share(of_joint, ticks) >= enough_in_time;
         });
}

SelfTestResult run_self_test(const Options& options, ControllerState& state, const std::atomic<bool>& stop) {
  SelfTestResult result;
  const auto ran = run_with_clock(options, state, [&](hal::Clock& clock) {
    Test test(options, state, stop, clock);
    run(test);
    result = test.result;
  });
  if (!ran) result.failure = ran.error();
  return result;
}

std::string to_text(const SelfTestResult& result) {
  if (!result.failure.empty()) return result.failure + '\n';
  std::string text;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    char replies[160];
    std::snprintf(replies, sizeof replies, "%-14s %.2f %% of %lld commands answered, %.2f %% in time\n",
                  kJointNames[joint], 100 * share(result.answered[joint], result.commands[joint]),
                  result.commands[joint], 100 * share(result.in_time[joint], result.ticks));
    text += replies;
  }
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    const hal::JointReading& reading = result.last.joints[joint];
    text += std::string(kJointNames[joint]) + " at " + measured(reading.position_rad, "rad") + ", driver " +
            measured(reading.driver_temperature_C, "C") + ", supply " + measured(reading.supply_V, "V") +
            '\n';
  }
  text += "torso sensor   " + std::to_string(result.base_readings) + " readings, pitch " +
          measured(result.last.base.pitch_rad, "rad") + '\n';
  text += "bus errors     " + std::to_string(result.bus_errors) + '\n';
  text += line("round trip", result.round_trip.percentiles());
  text += line("wake-up", result.wakeup_latency.percentiles());
  if (result.passed()) return text + "passed\n";
  if (result.answered_enough()) {
    return text +
           "failed: the drivers answer, but too late for runtime.self_test_in_time_share; see wake-up "
           "and round trip for who is late\n";
  }
  return text + "failed: a driver answers less than runtime.self_test_answered_share of its commands\n";
}

std::string to_json(const SelfTestResult& result) {
  const auto percentiles = [](const diagnostics::Histogram& histogram) {
    const diagnostics::Percentiles time_us = histogram.percentiles();
    return nlohmann::ordered_json{{"p50", time_us.p50_us}, {"p99", time_us.p99_us}, {"max", time_us.max_us}};
  };
  nlohmann::ordered_json json;
  json["passed"] = result.passed();
  if (!result.failure.empty()) json["failure"] = result.failure;
  json["commands"] = result.ticks;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    json["reply_share"][kJointNames[joint]] = share(result.answered[joint], result.commands[joint]);
    json["in_time_share"][kJointNames[joint]] = share(result.in_time[joint], result.ticks);
    json["position_rad"][kJointNames[joint]] = result.last.joints[joint].position_rad;
  }
  json["base_readings"] = result.base_readings;
  json["base_pitch_rad"] = result.last.base.pitch_rad;
  json["bus_errors"] = result.bus_errors;
  json["bus_round_trip_us"] = percentiles(result.round_trip);
  json["wakeup_us"] = percentiles(result.wakeup_latency);
  return json.dump(2) + "\n";
}

}  // namespace stilt::program
