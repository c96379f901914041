#include "firmware/program/realtime_run.h"

#include <sys/resource.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "firmware/commissioning/session.h"
#include "firmware/diagnostics/histogram_text.h"
#include "firmware/program/black_box_file.h"
#include "firmware/program/interrupt_report.h"
#include "firmware/program/service_manager.h"
#include "firmware/program/torso_sensor_report.h"
#include "firmware/realtime/allocation_counter.h"
#include "firmware/realtime/pace.h"
#include "firmware/realtime/system_call_guard.h"
#include "firmware/realtime/thread.h"
#include "hal/robot/clock.h"
#include "hal/robot/round_trip.h"

// Threads and mailboxes: docs/decisions/0005-stiltd.md
namespace stilt::program {
namespace {

/// Every so many ticks the statistics go to housekeeping.
constexpr long long kStatisticsEvery = 250;
/// Every so many ticks the round trip on the buses is measured, within this share of the tick.
constexpr long long kRoundTripEvery = 50;
constexpr double kRoundTripShare = 0.7;
constexpr std::int64_t kHousekeepingPeriod_ns = 5'000'000;

std::int64_t period_ns(double rate_hz) { return std::llround(1e9 / rate_hz); }

long long page_faults() noexcept {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt + usage.ru_majflt;
}

/// What the threads share beside the mailboxes.
struct Run {
  const Options& options;
  ControllerState& state;
  hal::RoundTrip round_trip;
  std::atomic<bool> torque_done = false;
  std::atomic<bool> planner_end = false;
  std::atomic<bool> unguarded = false;  ///< --forbid-syscalls was asked for and cannot be had
};

/// On a real-time thread, before its work.
void guard(Run& run) noexcept {
  if (!run.options.forbid_syscalls) return;
  realtime::end_on_heap_use();
  if (!realtime::forbid_other_system_calls()) run.unguarded = true;
}

void publish(ControllerState& state) noexcept {
  state.loop_statistics.writer() = state.loop;
  state.loop_statistics.publish();
}

/// Listens for the replies to what this tick has sent. @return  newest known round trip
std::int64_t measure_round_trip(hal::RoundTrip& meter, hal::MonotonicClock& clock, std::int64_t sent_ns,
                                std::int64_t give_up_ns, ControllerState& state) noexcept {
  const std::int64_t took_ns = meter.measure(clock, sent_ns, give_up_ns);
  if (took_ns >= 0) state.loop.bus_round_trip.add_ns(took_ns);
  return meter.newest_ns();
}

/// The torque loop: until the supervisor is off.
void run_torque_loop(void* context) {
  Run& run = *static_cast<Run*>(context);
  guard(run);
  ControllerState& state = run.state;
  const std::int64_t overrun_ns =
      std::llround(1e9 * run.options.configuration.supervisor.torque_loop_overrun_s);
  const realtime::AllocationScope allocations;
  hal::MonotonicClock clock;
  const std::int64_t tick_ns = period_ns(run.options.configuration.timing.torque_rate_hz);
  realtime::Pace pace(clock.now_ns() + tick_ns, tick_ns);
  const long long faults_before = page_faults();
  control_loop::TickTiming timing;
  for (int ticks_off = 0; ticks_off < commissioning::kLastTicks;) {
    timing.now_ns = clock.sleep_until(pace.next_ns());
    timing.wakeup_latency_ns = timing.now_ns - pace.next_ns();
    state.control.tick(timing);
    const std::int64_t done_ns = clock.now_ns();
    timing.execution_ns = done_ns - timing.now_ns;
    state.loop.add_tick(timing.wakeup_latency_ns, timing.execution_ns, overrun_ns);
    if (state.loop.ticks % kRoundTripEvery == 0 && supervisor::drives(state.control.decision().state)) {
      const auto wait_ns = static_cast<std::int64_t>(kRoundTripShare * static_cast<double>(tick_ns));
      timing.bus_round_trip_ns =
          measure_round_trip(run.round_trip, clock, done_ns, pace.next_ns() + wait_ns, state);
    }
    state.loop.missed_periods += pace.advance(timing.now_ns, clock.now_ns());
    state.loop.heap_allocations = allocations.count();
    if (state.loop.ticks % kStatisticsEvery == 0) {
      state.loop.page_faults = page_faults() - faults_before;
      publish(state);
    }
    ticks_off = state.control.decision().state == supervisor::State::off ? ticks_off + 1 : 0;
  }
  state.loop.page_faults = page_faults() - faults_before;
  run.torque_done.store(true, std::memory_order_release);
}

/// One cycle on the newest request; nothing when it is still the last one.
void run_cycle(Run& run, hal::MonotonicClock& clock, std::int64_t& last_tick) noexcept {
  ControllerState& state = run.state;
  const control_loop::PlanningRequest& request = state.mail.requests.newest();
  if (request.tick == last_tick || !run.options.plans_at(request.time_s)) return;
  last_tick = request.tick;
  const std::int64_t start_ns = clock.now_ns();
  const bool fresh = state.planner.plan(request, state.mail);
  if (request.stance_episode == 0) return;
  finish_cycle(state, request, fresh, clock.now_ns() - start_ns);
}

/// The planner: plan_rate_hz at most, slower when solves take longer.
void run_planner(void* context) {
  Run& run = *static_cast<Run*>(context);
  guard(run);
  ControllerState& state = run.state;
  const realtime::AllocationScope allocations;
  hal::MonotonicClock clock;
  realtime::Pace pace(clock.now_ns(), period_ns(run.options.configuration.timing.plan_rate_hz));
  const long long faults_before = page_faults();
  std::int64_t last_tick = -1;
  while (!run.planner_end.load(std::memory_order_acquire)) {
    const std::int64_t began_ns = clock.sleep_until(pace.next_ns());
    run_cycle(run, clock, last_tick);
    pace.advance(began_ns, realtime::rested_ns(began_ns, clock.now_ns()));
    state.planning.heap_allocations = allocations.count();
    state.planning.page_faults = page_faults() - faults_before;
    if (state.planning.plans % 25 == 0) {
      state.planner_statistics.writer() = state.planning;
      state.planner_statistics.publish();
    }
  }
}

void print_statistics(ControllerState& state) {
  const LoopStatistics& loop = state.loop_statistics.newest();
  const PlannerStatistics& planning = state.planner_statistics.newest();
  std::fputs((diagnostics::to_text("wake-up", loop.wakeup_latency) +
              diagnostics::to_text("execution", loop.execution) +
              diagnostics::to_text("bus round trip", loop.bus_round_trip) +
              diagnostics::to_text("solve", planning.solve))
                 .c_str(),
             stderr);
}

/// A thread without its priority or processor is not real time, whatever the machine promised.
void report_refused(const realtime::Thread& thread, Outcome& outcome) {
  const std::string refused = thread.refused();
  if (refused.empty()) return;
  std::fprintf(stderr, "not real time: %s\n", refused.c_str());
  outcome.not_realtime += (outcome.not_realtime.empty() ? "" : "; ") + refused;
}

}  // namespace

void run_realtime(const Options& options, std::atomic<bool>& print_asked, ControllerState& state,
                  Outcome& outcome) {
  const configuration::RuntimeParameters& runtime = options.configuration.runtime;
  Run run{
      options, state,
      hal::RoundTrip(configuration::robot_wiring(options.configuration.hardware), state.hardware->buses())};
  BlackBoxFile black_box(options, state);
  realtime::Thread planner;
  realtime::Thread torque_loop;
  const bool started =
      planner.start({"planner", runtime.planner_priority, runtime.planner_core}, run_planner, &run) &&
      torque_loop.start({"torque loop", runtime.torque_priority, runtime.torque_core}, run_torque_loop, &run);
  if (!started) outcome.error = "threads cannot be started; raise the limits of memory and processes";
  for (const realtime::Thread* thread : {&torque_loop, &planner}) {
    if (started) report_refused(*thread, outcome);
  }
  hal::MonotonicClock clock;
  ServiceManager service(options.configuration.supervisor);
  TorsoSensorReport torso_sensor(options);
  InterruptWatch interrupts(configuration::bus_names(options.configuration.hardware), runtime);
  while (started && !run.torque_done.load(std::memory_order_acquire)) {
    operate(state);
    restore_buses(state);
    torso_sensor.update(state);
    for (const std::string& line : interrupts.update(state.newest_tick.state)) {
      std::fprintf(stderr, "stiltd: %s\n", line.c_str());
    }
    take_events(state.mail.events, outcome, state.telemetry_node);
    publish(state, state.loop_statistics.newest(), state.planner_statistics.newest());
    service.notify(clock.now_ns(), state.loop_statistics.newest().ticks,
                   supervisor::name(state.newest_tick.state));
    if (state.mail.stops.shut_down.load(std::memory_order_relaxed)) service.notify_stop_asked();
    black_box.save();
    if (print_asked.exchange(false)) print_statistics(state);
    static_cast<void>(clock.sleep_until(clock.now_ns() + kHousekeepingPeriod_ns));
  }
  service.notify_stopping();
  torque_loop.join();
  run.planner_end.store(true, std::memory_order_release);
  planner.join();
  if (run.unguarded) outcome.error = "--forbid-syscalls: this kernel has no seccomp filters";
  take_events(state.mail.events, outcome, state.telemetry_node);
  flush_telemetry(state);
  if (const auto saved = black_box.finish(); !saved) outcome.not_written = saved.error();
}

}  // namespace stilt::program
