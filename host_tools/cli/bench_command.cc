#include "host_tools/cli/bench_command.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "firmware/program/instruction_sets.h"
#include "host_tools/cli/bench_output.h"
#include "host_tools/cli/closed_loop_bench.h"
#include "host_tools/cli/json_output.h"
#include "host_tools/cli/planner_timing.h"
#include "host_tools/cli/planning_problems.h"
#include "host_tools/cli/usage_error.h"
#include "host_tools/simulation/plant/number.h"

namespace stilt::cli {
namespace {

constexpr int kRounds = 400;
constexpr int kMostProblems = 100000;
constexpr double kLargestSpeed_m_s = 5.0;

/// Measures the phases on the last problem of the list.
benchmark::PhaseSpeeds measure_last(const control::Planner& planner) {
  const auto work = std::make_unique<benchmark::WorkTable>();
  const auto kernels = std::make_unique<benchmark::PlannerKernels>(planner);
  return benchmark::measure_phases(*kernels, work->work_of(planner), kRounds);
}

}  // namespace

CLI::App* add_bench_command(CLI::App& program, BenchOptions& options) {
  CLI::App* bench = program.add_subcommand("bench", "time the planner on the problems of a walk");
  add_controller_options(*bench, options.choice);
  bench->add_flag("--no-early-stop", options.choice.no_early_stop, "use all iterations");
  bench->add_option("--problems", options.problems, "planning problems to record and solve")
      ->capture_default_str();
  bench->add_option(
      "--closed-loop", options.closed_loop_plans,
      "time this many consecutive plans of a walk instead, with all iterations, and compare the "
      "longest with the median");
  bench->add_option("--speed", options.speed_m_s, "speed of the recorded walk, m/s")->capture_default_str();
  bench
      ->add_option(
          "--push", options.pushes,
          "with --closed-loop: a push, N@START+DURATION[@hip|torso], positive forward, from tick to tick; "
          "repeatable")
      ->allow_extra_args(false);
  bench->add_option("--json", options.json_file,
                    "writes the results as JSON to a file, or - for standard output");
  return bench;
}

int run_bench(const BenchOptions& options) {
  if (options.problems < 1 || options.problems > kMostProblems) {
    throw UsageError("--problems " + std::to_string(options.problems) + ": must be from 1 to " +
                     std::to_string(kMostProblems));
  }
  if (!(std::abs(options.speed_m_s) <= kLargestSpeed_m_s)) {
    throw UsageError("--speed " + simulation::number_text(options.speed_m_s) +
                     ": the speed must lie within 5 m/s either way");
  }
  if (options.closed_loop_plans < 0 || options.closed_loop_plans > kMostProblems) {
    throw UsageError("--closed-loop " + std::to_string(options.closed_loop_plans) + ": must be from 1 to " +
                     std::to_string(kMostProblems));
  }
  if (!options.pushes.empty() && options.closed_loop_plans == 0) {
    throw UsageError("--push " + options.pushes.front() + ": needs --closed-loop");
  }
  if (options.choice.controller == "hzd-pd") {
    throw UsageError("--controller hzd-pd: it tracks gaits without planning; choose one that plans");
  }
  check_output_files({{"--json", options.json_file}}, files_read(options.choice));
  if (options.closed_loop_plans > 0) return run_closed_loop_bench(options);
  const model::RobotModel& robot = robot_model(options.choice.robot);
  configuration::Configuration parameters = controller_configuration(options.choice);
  program::choose_instruction_set(parameters);
  const auto controller = make_controller(controller_setup(options.choice, robot, parameters));
  ControllerChoice recorded = options.choice;
  recorded.horizon_s.reset();
  recorded.iterations.reset();
  recorded.no_early_stop = false;
  const PlanningProblems problems = record_walk(recorded, options.speed_m_s, options.problems);
  const PlannerTimings timings = time_planner(controller->planner(), problems);
  // The kernels alone are those of the build.
  parameters.sqp.instruction_set = dispatch::instruction_set_of_build();
  const auto of_build = make_controller(controller_setup(options.choice, robot, parameters));
  static_cast<void>(time_planner(of_build->planner(), problems));
  const benchmark::PhaseSpeeds speeds = measure_last(*benchmark::planner_of_build(of_build->planner()));
  if (!options.json_file.empty()) write_json(bench_json(timings, speeds), options.json_file);
  if (options.json_file != "-") print_bench(timings, speeds, parameters.discretisation.horizon_s);
  if (!problems.survived) std::fputs("stilt bench: the robot fell in the recorded walk\n", stderr);
  return problems.survived && timings.failed == 0 ? 0 : 1;
}

}  // namespace stilt::cli
