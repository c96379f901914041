#include "firmware/program/self_test.h"

#include <algorithm>
#include <cmath>

#include "firmware/commissioning/formatted.h"
#include "firmware/commissioning/session.h"
#include "firmware/program/commissioning_requests.h"
#include "firmware/program/commissioning_run.h"
#include "firmware/program/interrupt_report.h"
#include "firmware/program/planner_load.h"
#include "hal/robot/clock.h"
#include "hal/robot/round_trip.h"

namespace stilt::program {
namespace {

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
    const configuration::Configuration& configuration = asked.configuration;
    result.limits = {configuration.runtime.self_test_answered_share,
                     configuration.runtime.self_test_in_time_share,
                     configuration.runtime.self_test_late_share,
                     configuration.supervisor.torque_loop_overrun_s,
                     static_cast<std::uint32_t>(configuration.supervisor.missed_damp_ticks),
                     1.0 / configuration.timing.plan_rate_hz,
                     configuration.runtime.planner_priority,
                     asked.accept_missing_stop,
                     asked.hangs};
    result.lockstep = asked.lockstep;
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
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    if (result.fault[joint] != hal::DriverFault::none) continue;
    result.fault[joint] = readings.joints[joint].fault;
    result.fault_code[joint] = readings.joints[joint].fault_code;
  }
  result.emergency_stop_pressed |= readings.emergency_stop == hal::EmergencyStopState::pressed;
  result.emergency_stop_silent |= readings.emergency_stop == hal::EmergencyStopState::unknown;
  if (base_is_new) ++result.base_readings;
  result.keep_most_missed(readings);
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
void command_robot(Test& test, commissioning::Session& session) {
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
    const std::int64_t wakeup_latency_ns = session.begin_tick() - due_ns;
    test.result.wakeup_latency.add_ns(wakeup_latency_ns);
    if (static_cast<double>(wakeup_latency_ns) > 1e9 * test.result.limits.wakeup_latency_max_s)
      ++test.result.late_ticks;
    const bool base_is_new = session.readings().base.time_ns != newest_base_ns;
    if (tick > 0) count(test, session.readings(), base_is_new);  // the first command has no predecessor
    if (test.result.bus_trouble.empty()) test.result.bus_trouble = session.bus_trouble();
    if (test.result.limit_trouble.empty()) test.result.limit_trouble = session.limit_trouble();
    forget(test);
    if (tick < ticks && test.stop.load()) {
      const double after_s = static_cast<double>(tick) * session.tick_s();
      test.result.stopped =
          commissioning::formatted("stopped after %.1f of %g s", after_s, test.options.self_test_s);
    }
    if (tick == ticks || !test.result.stopped.empty()) break;
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

/// The same with the planner at work, and what the kernel reports of the processors.
void command_under_load(Test& test, commissioning::Session& session) {
  const int core = test.options.configuration.runtime.torque_core;
  const std::optional<long long> throttled = realtime::thermal_throttle_count();
  PlannerLoad load(test.options, test.state);
  if (!load.start()) {
    test.result.failure = "no thread for the planner";
    return;
  }
  command_robot(test, session);
  load.end();
  test.result.solve = load.solve();
  test.result.failed_solves = load.failed();
  test.result.planner_s = load.duration_s();
  const auto interrupts =
      realtime::bus_interrupts(configuration::bus_names(test.options.configuration.hardware));
  test.result.interrupts = delayed_threads(interrupts, test.options.configuration.runtime);
  test.result.interrupt_sentences = interrupt_sentences(interrupts);
  test.result.idle = realtime::deepest_idle_state(core);
  if (throttled) test.result.throttled = realtime::thermal_throttle_count().value_or(*throttled) - *throttled;
}

void run(Test& test) {
  const auto tick_ns = std::llround(1e9 / test.options.configuration.timing.torque_rate_hz);
  commissioning::Session session(*test.state.hardware, test.clock, tick_ns, test.stop,
                                 driver_limits(test.options));
  if (const auto up = session.bring_up()) {
    test.options.lockstep ? command_robot(test, session) : command_under_load(test, session);
  } else {
    test.result.failure = up.error();
  }
  session.disable();
}

}  // namespace

void SelfTestResult::keep_most_missed(const hal::RobotReadings& readings) noexcept {
  const auto keep = [this](std::uint32_t& most, std::uint32_t now) {
    most = std::max(most, static_cast<std::uint32_t>(std::min<long long>(now, ticks)));
  };
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    keep(missed[joint], readings.joints[joint].missed_replies);
  }
  keep(base_missed, readings.base.missed_replies);
}

SelfTestResult run_self_test(const Options& options, ControllerState& state, const std::atomic<bool>& stop,
                             bool idle_held) {
  SelfTestResult result;
  const auto ran = run_with_clock(options, state, [&](hal::Clock& clock) {
    Test test(options, state, stop, clock);
    run(test);
    result = test.result;
    if (idle_held) result.idle_held_us = 1e6 * options.configuration.runtime.idle_exit_max_s;
  });
  if (!ran) result.failure = ran.error();
  return result;
}

}  // namespace stilt::program
