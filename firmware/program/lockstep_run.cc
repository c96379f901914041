#include "firmware/program/lockstep_run.h"

#include "firmware/commissioning/session.h"
#include "firmware/control_loop/planner_schedule.h"
#include "firmware/program/black_box_file.h"
#include "firmware/program/torso_sensor_report.h"
#include "firmware/realtime/allocation_counter.h"
#include "hal/robot/clock.h"

namespace stilt::program {
namespace {

/// How long the simulated robot may take for one tick.
constexpr double kPatience_s = 10.0;
/// Ticks after the robot stopped answering: enough for what its silence leads to.
constexpr int kTicksAlone = 100;

}  // namespace

void run_lockstep(const Options& options, std::size_t bus_count, ControllerState& state, Outcome& outcome) {
  control_loop::PlannerSchedule schedule(options.configuration.timing);
  const std::int64_t tick_ns = schedule.timing().tick_ns;
  hal::LockstepClock clock(std::span(state.lockstep_buses).first(bus_count), tick_ns, kPatience_s);
  hal::MonotonicClock wall;
  if (!clock.open()) {
    outcome.error = "the simulated robot does not answer in lock-step; start stilt robot with --lockstep too";
    return;
  }
  std::int64_t next_ns = clock.now_ns();
  int ticks_off = 0, ticks_alone = 0;
  TorsoSensorReport torso_sensor(options);
  BlackBoxFile black_box(options, state);
  for (long long tick = 0; ticks_off < commissioning::kLastTicks && ticks_alone < kTicksAlone; ++tick) {
    operate(state);
    publish(state, state.loop, state.planning);
    {
      const realtime::AllocationScope allocations;
      schedule.publish_due(tick, state.planner, state.mail);
      const std::int64_t start_ns = wall.now_ns();
      state.control.tick({.now_ns = clock.now_ns()});
      state.loop.execution.add_ns(wall.now_ns() - start_ns);
      if (options.plans_at(state.control.time_s())) {
        if (const auto solve_ns = schedule.plan(tick, state.planner, state.mail, wall)) {
          state.planning.solve.add_ns(*solve_ns);
          ++state.planning.plans;
        }
      }
      state.loop.heap_allocations += allocations.count();
    }
    take_events(state.mail.events, outcome, state.telemetry_node);
    restore_buses(state);
    torso_sensor.update(state);
    black_box.save();
    ++state.loop.ticks;
    ticks_off = state.control.decision().state == supervisor::State::off ? ticks_off + 1 : 0;
    next_ns += tick_ns;
    static_cast<void>(clock.sleep_until(next_ns));
    if (clock.lost() && ticks_alone++ == 0) {
      outcome.error = "the simulated robot stopped answering in tick " + std::to_string(tick + 1);
    }
  }
  flush_telemetry(state);
  if (const auto saved = black_box.finish(); !saved) outcome.not_written = saved.error();
}

}  // namespace stilt::program
