#include "host_tools/cli/bench_command.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numeric>
#include <vector>

#include "host_tools/cli/json_output.h"
#include "host_tools/cli/planning_problems.h"
#include "host_tools/cli/progress.h"
#include "host_tools/cli/usage_error.h"
#include "host_tools/cli/version.h"
#include "host_tools/simulator/number.h"
#include "host_tools/simulator/run_recorder.h"

namespace stilt::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMostProblems = 100000;
constexpr double kLargestSpeed_m_s = 5.0;

long long steady_ns() noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// One list a quantity, one entry a problem.
struct Timings {
  std::vector<double> solve_us, linearise_us, riccati_us, line_search_us, other_us, iterations;
  int nodes_max = 0;
  int failed = 0;
};

double mean(const std::vector<double>& values) {
  if (values.empty()) return 0.0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double maximum(const std::vector<double>& values) {
  return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

Timings time_planner(control::Planner& planner, const std::vector<control::PlannerInput>& inputs) {
  Timings timings;
  const auto plan = std::make_unique<control::Plan>();
  Progress progress("timing the planner", static_cast<double>(inputs.size()), "plans");
  planner.set_clock(steady_ns);
  planner.reset(0.0);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const long long start_ns = steady_ns();
    const solver::SolveReport report = planner.plan(inputs[i], *plan);
    const double solve_us = 1e-3 * static_cast<double>(steady_ns() - start_ns);
    const solver::PhaseTimes& phases = planner.phase_times();
    timings.solve_us.push_back(solve_us);
    timings.linearise_us.push_back(phases.linearise_us);
    timings.riccati_us.push_back(phases.riccati_us);
    timings.line_search_us.push_back(phases.line_search_us);
    timings.other_us.push_back(solve_us - phases.linearise_us - phases.riccati_us - phases.line_search_us);
    timings.iterations.push_back(report.iterations);
    timings.nodes_max = std::max(timings.nodes_max, plan->nodes);
    if (!report.usable()) ++timings.failed;
    progress.update(static_cast<double>(i + 1));
  }
  return timings;
}

Json bench_json(const Timings& timings) {
  Json json;
  json["nodes"] = timings.nodes_max;
  json["solve_us"] = to_json(simulator::percentiles(timings.solve_us));
  json["rate_hz"] = 1e6 / mean(timings.solve_us);
  json["phases_us"] = {{"linearise", mean(timings.linearise_us)},
                       {"riccati", mean(timings.riccati_us)},
                       {"line_search", mean(timings.line_search_us)},
                       {"other", mean(timings.other_us)}};
  json["iterations"] = {{"mean", mean(timings.iterations)},
                        {"max", static_cast<int>(maximum(timings.iterations))}};
  json["isa"] = instruction_set();
  json["threads"] = 1;
  json["problems"] = timings.solve_us.size();
  json["failed"] = timings.failed;
  return json;
}

void print(const Timings& timings, double horizon_s) {
  const log::Percentiles solve_us = simulator::percentiles(timings.solve_us);
  std::printf("planner        %zu problems of a walk, horizon %.2f s, at most %d nodes, %s, 1 thread\n",
              timings.solve_us.size(), horizon_s, timings.nodes_max, instruction_set().c_str());
  std::printf("solve          p50 %.0f, p99 %.0f, max %.0f us; %.0f solves a second on average\n",
              solve_us.p50, solve_us.p99, solve_us.max, 1e6 / mean(timings.solve_us));
  std::printf("phases         linearise %.0f, riccati %.0f, line search %.0f, other %.0f us on average\n",
              mean(timings.linearise_us), mean(timings.riccati_us), mean(timings.line_search_us),
              mean(timings.other_us));
  std::printf("iterations     %.1f on average, %.0f at most; %d solves gave no plan\n",
              mean(timings.iterations), maximum(timings.iterations), timings.failed);
}

}  // namespace

CLI::App* add_bench_command(CLI::App& program, BenchOptions& options) {
  CLI::App* bench = program.add_subcommand("bench", "time the planner on the problems of a walk");
  add_controller_options(*bench, options.choice);
  bench->add_flag("--no-early-stop", options.choice.no_early_stop, "use all iterations");
  bench->add_option("--problems", options.problems, "planning problems to record and solve")
      ->capture_default_str();
  bench->add_option("--speed", options.speed_m_s, "speed of the recorded walk, m/s")->capture_default_str();
  bench->add_option("--json", options.json_file,
                    "writes the figures as JSON to a file, or - for standard output");
  return bench;
}

int run_bench(const BenchOptions& options) {
  if (options.problems < 1 || options.problems > kMostProblems) {
    throw UsageError("--problems " + std::to_string(options.problems) + ": must be from 1 to " +
                     std::to_string(kMostProblems));
  }
  if (!(std::abs(options.speed_m_s) <= kLargestSpeed_m_s)) {
    throw UsageError("--speed " + simulator::number_text(options.speed_m_s) +
                     ": the speed must lie within 5 m/s either way");
  }
  check_output_file("--json", options.json_file);
  const model::RobotModel& robot = robot_model(options.choice.robot);
  const control::ControllerParameters parameters = controller_parameters(options.choice);
  const auto controller = make_controller(robot, parameters);
  ControllerChoice recorded = options.choice;
  recorded.horizon_s.reset();
  recorded.iterations.reset();
  recorded.no_early_stop = false;
  const PlanningProblems problems =
      record_walk(options.choice.robot, controller_parameters(recorded), options.speed_m_s, options.problems);
  const Timings timings = time_planner(controller->planner(), problems.inputs);
  if (!options.json_file.empty()) write_json(bench_json(timings), options.json_file);
  if (options.json_file != "-") print(timings, parameters.discretisation.horizon_s);
  if (!problems.survived) std::fputs("stilt bench: the robot fell in the recorded walk\n", stderr);
  return problems.survived && timings.failed == 0 ? 0 : 1;
}

}  // namespace stilt::cli
