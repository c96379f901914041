#include "firmware/program/lockstep_run.h"

#include <algorithm>
#include <cmath>

#include "firmware/controller/planning_turn.h"
#include "firmware/realtime/allocation_counter.h"
#include "hal/clock.h"

namespace stilt::program {
namespace {

/// How long the simulated robot may take for one tick.
constexpr double kPatience_s = 10.0;
/// Ticks after the end: the last commands leave the buses.
constexpr int kLastTicks = 5;
/// Ticks after the robot stopped answering: enough for what its silence leads to.
constexpr int kTicksAlone = 100;

/// When plans are made and come into use, in ticks; as in the simulation (host_tools/simulator).
struct Schedule {
  std::int64_t tick_ns;
  long long plan_period;
  long long plan_delay;

  explicit Schedule(const control::TimingParameters& timing)
      : tick_ns(std::llround(1e9 / timing.torque_rate_hz)),
        plan_delay(std::max(1LL, std::llround(timing.plan_delay_s * timing.torque_rate_hz))) {
    plan_period = std::max(plan_delay, std::llround(timing.torque_rate_hz / timing.plan_rate_hz));
  }
};

/// The planner's turns.
class PlanningTurns {
 public:
  PlanningTurns(ControllerState& state, const Schedule& schedule) : state_(state), schedule_(schedule) {}

  /// Before the torque loop's tick: a plan that is due comes into use.
  void hand_over(long long tick) {
    if (tick != due_) return;
    if (fresh_) state_.mail.plans.publish();
    state_.mail.results.writer() = state_.planner.result();
    state_.mail.results.publish();
  }

  /// After it: plans from the state of this tick when it is time to.
  void plan(long long tick) {
    const controller::PlanningRequest& request = state_.mail.requests.newest();
    const bool begins = request.session != session_;
    session_ = request.session;
    if (session_ == 0 || tick < due_) return;
    if (!begins && tick % schedule_.plan_period != 0) return;
    const std::int64_t start_ns = clock_.now_ns();
    fresh_ = turn_.plan(state_.planner, request, state_.mail);
    state_.planning.solve.add_ns(clock_.now_ns() - start_ns);
    turn_.tell(state_.planner, request, fresh_, 0, state_.mail);
    ++state_.planning.plans;
    due_ = tick + schedule_.plan_delay;
  }

 private:
  ControllerState& state_;
  Schedule schedule_;
  controller::PlanningTurn turn_;
  hal::MonotonicClock clock_;  // for the figures only
  std::uint32_t session_ = 0;
  long long due_ = -1;
  bool fresh_ = false;
};

}  // namespace

void run_lockstep(const Options& options, std::size_t bus_count, Signals& signals, ControllerState& state,
                  Outcome& outcome) {
  const Schedule schedule(options.configuration.timing);
  hardware::LockstepClock clock(std::span(state.lockstep_buses).first(bus_count), schedule.tick_ns,
                                kPatience_s);
  PlanningTurns planner(state, schedule);
  hal::MonotonicClock wall;
  if (!clock.open()) {
    outcome.error = "the simulated robot does not answer in lock-step; start stilt robot with --lockstep too";
    return;
  }
  std::int64_t next_ns = clock.now_ns();
  int ticks_off = 0, ticks_alone = 0;
  for (long long tick = 0; ticks_off < kLastTicks && ticks_alone < kTicksAlone; ++tick) {
    const std::int64_t start_ns = wall.now_ns();
    operate(state, signals.stop);
    tell(state, state.loop, state.planning);
    {
      const realtime::AllocationScope allocations;
      planner.hand_over(tick);
      state.torque.tick({.now_ns = clock.now_ns()});
      state.loop.execution.add_ns(wall.now_ns() - start_ns);
      if (options.plans_at(state.torque.time_s())) planner.plan(tick);
      state.loop.heap_allocations += allocations.count();
    }
    take_events(state.mail.events, outcome, state.station);
    restore_buses(state);
    ++state.loop.ticks;
    ticks_off = state.torque.decision().state == supervisor::State::off ? ticks_off + 1 : 0;
    next_ns += schedule.tick_ns;
    static_cast<void>(clock.sleep_until(next_ns));
    if (clock.lost() && ticks_alone++ == 0) {
      outcome.error = "the simulated robot stopped answering in tick " + std::to_string(tick + 1);
    }
  }
  finish_telling(state);
}

}  // namespace stilt::program
