#include "host_tools/cli/planner_timing.h"

#include <algorithm>
#include <chrono>
#include <memory>

#include "host_tools/cli/progress.h"

namespace stilt::cli {
namespace {

long long steady_ns() noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

PlannerTimings time_planner(dispatch::DispatchedPlanner& dispatched, const PlanningProblems& problems) {
  control::PlannerInterface& planner = dispatched.planner();
  PlannerTimings timings;
  timings.instruction_set = model::name_of(dispatched.instruction_set());
  const auto plan = std::make_unique<control::Plan>();
  const std::vector<control::PlannerInput>& inputs = problems.inputs;
  Progress progress("timing the planner", static_cast<double>(inputs.size()), "plans");
  planner.set_clock(steady_ns);
  planner.reset(0.0);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const long long start_ns = steady_ns();
    const sqp::SolveReport report = planner.plan(inputs[i], *plan);
    const double solve_us = 1e-3 * static_cast<double>(steady_ns() - start_ns);
    if (!report.usable()) ++timings.failed;
    progress.update(static_cast<double>(i + 1));
    if (i < problems.lead) continue;
    const sqp::PhaseTimes& phases = planner.phase_times();
    timings.solve_us.push_back(solve_us);
    timings.linearise_us.push_back(phases.linearise_us);
    timings.riccati_us.push_back(phases.riccati_us);
    timings.line_search_us.push_back(phases.line_search_us);
    timings.other_us.push_back(solve_us - phases.linearise_us - phases.riccati_us - phases.line_search_us);
    timings.iterations.push_back(report.iterations);
    timings.nodes_max = std::max(timings.nodes_max, plan->nodes);
  }
  return timings;
}

}  // namespace stilt::cli
