#include "host_tools/simulator/closed_loop.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "firmware/realtime/allocation_counter.h"
#include "host_tools/simulator/run_recorder.h"

namespace stilt::simulator {
namespace {

/// A controller's calls with their cost: solve time of the wall clock, heap allocations.
class WatchedController {
 public:
  explicit WatchedController(Controller& controller) : controller_(controller) {}

  TickOutput tick(const control::SensorReading& reading, const model::StateVector* true_state) {
    const realtime::AllocationScope scope;
    const TickOutput output = controller_.tick(reading, true_state);
    allocations_ += scope.count();
    return output;
  }

  std::optional<log::SolveSample> plan(double time_s, const gait::GaitCommand& command) {
    const realtime::AllocationScope scope;
    const auto start = std::chrono::steady_clock::now();
    const std::optional<solver::SolveReport> report = controller_.plan(time_s, command);
    const std::chrono::duration<double, std::micro> elapsed = std::chrono::steady_clock::now() - start;
    allocations_ += scope.count();
    if (!report) return std::nullopt;
    return log::SolveSample{time_s, elapsed.count(), *report};
  }

  void adopt_plan() {
    const realtime::AllocationScope scope;
    controller_.adopt_plan();
    allocations_ += scope.count();
  }

  [[nodiscard]] long long allocations() const { return allocations_; }

 private:
  Controller& controller_;
  long long allocations_ = 0;
};

}  // namespace

TickSchedule::TickSchedule(const control::TimingParameters& timing) : tick_s(1.0 / timing.torque_rate_hz) {
  const int delay = static_cast<int>(std::lround(timing.plan_delay_s * timing.torque_rate_hz));
  plan_delay_ticks = std::max(1, delay);
  const int period = static_cast<int>(std::lround(timing.torque_rate_hz / timing.plan_rate_hz));
  plan_period_ticks = std::max(period, plan_delay_ticks);
}

double time_step_for_tick(double wished_s, double tick_s) {
  return tick_s / std::ceil(tick_s / wished_s - 1e-9);
}

log::RunRecord run_closed_loop(Plant& plant, Controller& controller, const RunSettings& settings) {
  const TickSchedule schedule(settings.timing);
  const int steps_a_tick = static_cast<int>(std::lround(schedule.tick_s / plant.time_step_s()));
  const long long ticks = std::llround(settings.duration_s / schedule.tick_s);
  const long long progress_ticks = std::llround(1.0 / schedule.tick_s);
  log::RunRecord record;
  RunRecorder recorder(settings, record);
  WatchedController watched(controller);
  const auto plan = [&](double time_s) {
    const auto solve = watched.plan(time_s, command_at(settings.commands, time_s));
    if (solve) recorder.observe_plan(*solve, controller.newest_plan());
  };
  plant.set_state(settings.initial_state);
  controller.reset(settings.initial_state, 0.0);
  plan(0.0);
  long long adopt_at_tick = 0;
  long long tick = 0;
  for (; tick < ticks && plant.fall() == Fall::none; ++tick) {
    const double time_s = static_cast<double>(tick) * schedule.tick_s;
    if (tick == adopt_at_tick) watched.adopt_plan();
    control::SensorReading reading = plant.read_sensors();
    reading.time_s = time_s;
    const model::StateVector truth = plant.state();
    const TickOutput output = watched.tick(reading, settings.use_true_state ? &truth : nullptr);
    if (tick > 0 && tick % schedule.plan_period_ticks == 0) {
      plan(time_s);
      adopt_at_tick = tick + schedule.plan_delay_ticks;
    }
    const ActingPush push = push_at(settings.pushes, time_s);
    plant.set_push(push.force_N, push.point);
    plant.command_torque(output.torque_Nm);
    recorder.observe_tick(time_s, plant, output, controller);
    for (int step = 0; step < steps_a_tick; ++step) {
      plant.step();
      recorder.observe_step(plant);
    }
    if ((tick + 1) % progress_ticks == 0) settings.progress(time_s + schedule.tick_s);
  }
  recorder.finish(static_cast<double>(tick) * schedule.tick_s, plant, controller, watched.allocations());
  return record;
}

}  // namespace stilt::simulator
