#include "firmware/program/planner_load.h"

#include <cmath>

#include "firmware/realtime/pace.h"
#include "firmware/robots/robots.h"
#include "hal/robot/clock.h"
#include "mpc_core/gait/reference.h"

namespace stilt::program {
namespace {

constexpr gait::GaitCommand kWalk{gait::GaitKind::walk, 0.5};
constexpr double kAnew_s = 1.0;

}  // namespace

double PlannerLoad::period_s() const noexcept { return 1.0 / options_.configuration.timing.plan_rate_hz; }

double PlannerLoad::duration_s() const noexcept {
  return 1e-9 * static_cast<double>(ended_ns_ - started_ns_);
}

bool PlannerLoad::start() {
  const configuration::RuntimeParameters& runtime = options_.configuration.runtime;
  started_ns_ = hal::MonotonicClock().now_ns();
  return thread_.start({"planner", runtime.planner_priority, runtime.planner_core}, &run, this);
}

void PlannerLoad::end() {
  ended_ns_ = hal::MonotonicClock().now_ns();
  end_.store(true, std::memory_order_relaxed);
  thread_.join();
}

void PlannerLoad::run(void* load) { static_cast<PlannerLoad*>(load)->plan(); }

void PlannerLoad::plan() {
  const auto& robot = robots::find(options_.configuration.hardware.robot).value()->model.constants;
  const configuration::Configuration& parameters = options_.configuration;
  const model::StateVector standing =
      gait::standing_state(robot, parameters.reference.base_height_m, parameters.reference.base_pitch_rad,
                           parameters.gait.stand_half_width_m, true);
  control::Plan& plan = state_.mail.plans.writer();
  control_loop::PlanningRequest request;
  request.command = kWalk;
  hal::MonotonicClock clock;
  const auto period_ns = std::llround(1e9 * period_s());
  realtime::Pace pace(clock.now_ns() + period_ns, period_ns);
  double anew_s = 0.0;
  while (!end_.load(std::memory_order_relaxed)) {
    const std::int64_t began_ns = clock.sleep_until(pace.next_ns());
    request.time_s += period_s();
    ++request.tick;
    if (request.time_s >= anew_s || !state_.planner.report().usable()) {
      anew_s = request.time_s + kAnew_s;
      ++request.stance_episode;
      request.state = standing;
    } else {
      request.state = control::interpolate(plan, request.time_s).state;
    }
    if (!state_.planner.cycle(request, plan)) ++failed_;
    const std::int64_t done_ns = clock.now_ns();
    solve_.add_ns(done_ns - began_ns);
    pace.advance(began_ns, realtime::rested_ns(began_ns, done_ns));
  }
}

}  // namespace stilt::program
