#include "host_tools/simulation/closed_loop/closed_loop.h"

#include <cmath>

#include "firmware/realtime/allocation_counter.h"
#include "host_tools/simulation/closed_loop/plant_robot.h"
#include "host_tools/simulation/closed_loop/run_recorder.h"

namespace stilt::simulation {

namespace {

/// Adds the heap allocations of a call to `allocations`.
template <class Call>
decltype(auto) counted(long long& allocations, Call&& call) {
  const realtime::AllocationScope scope;
  decltype(auto) result = call();
  allocations += scope.count();
  return result;
}

}  // namespace

log::RunRecord run_closed_loop(Plant& plant, SimulatedController& controller, const RunSettings& settings) {
  log::RunRecord record;
  const control_loop::PlanTiming& timing = controller.timing();
  const double tick_s = 1e-9 * static_cast<double>(timing.tick_ns);
  PlantRobot robot(plant, settings.faults, tick_s);
  plant.set_state(settings.initial_state);
  model::StateVector truth = plant.state();
  const model::StateVector* known_state = settings.use_true_state ? &truth : nullptr;
  (void)settings.observer.plans(0.0);
  const std::int64_t first_ns = controller.begin(robot, command_at(settings.commands, 0.0), known_state);

  const int steps_per_tick = static_cast<int>(std::lround(tick_s / plant.time_step_s()));
  const long long ticks = std::llround(settings.duration_s / tick_s);
  const long long progress_ticks = std::llround(1.0 / tick_s);
  RunRecorder recorder(settings, timing, controller.parameters().inequality.friction_coefficient, record);
  const auto observe_plan = [&](std::int64_t solve_ns) {
    const double time_s = controller.request().time_s;
    recorder.observe_plan({time_s, 1e-3 * static_cast<double>(solve_ns), controller.report()},
                          controller.newest_plan());
    settings.observer.planned(controller.request(), controller.report());
  };
  observe_plan(first_ns);

  long long tick = 0;
  long long allocations = 0;
  const auto stopped = [&] { return settings.stop != nullptr && settings.stop->load(); };
  for (; tick < ticks && plant.fall() == Fall::none && !stopped(); ++tick) {
    const double time_s = static_cast<double>(tick) * tick_s;
    truth = plant.state();
    const gait::GaitCommand command = command_at(settings.commands, time_s);
    const control_loop::TickRecord& done =
        counted(allocations, [&]() -> auto& { return controller.tick(tick, command, known_state); });
    if (time_s < settings.planner_until_s && settings.observer.plans(time_s)) {
      const auto solve_ns = counted(allocations, [&] { return controller.plan(tick); });
      if (solve_ns) observe_plan(*solve_ns);
    }
    robot.set_time(time_s);
    const ActingPush push = push_at(settings.pushes, time_s);
    plant.set_push(push.force_N, push.point);
    recorder.observe_tick(time_s, plant, done, controller.active_plan());
    settings.observer.ticked(done);
    for (int step = 0; step < steps_per_tick; ++step) {
      robot.drive();
      plant.step();
      recorder.observe_step(plant);
    }
    if ((tick + 1) % progress_ticks == 0) settings.progress(time_s + tick_s);
  }
  recorder.finish(static_cast<double>(tick) * tick_s, plant, allocations);
  return record;
}

}  // namespace stilt::simulation
