#pragma once

#include <CLI/App.hpp>
#include <string>

#include "host_tools/cli/controller_choice.h"

namespace stilt::cli {

/// Options of `stilt bench`.
struct BenchOptions {
  ControllerChoice choice;
  int problems = 400;
  int closed_loop_plans = 0;  ///< 0: the recorded problems are timed instead
  double speed_m_s = 0.5;
  std::string json_file;
};

/// Adds `bench` to the program; its options end up in `options`.
CLI::App* add_bench_command(CLI::App& program, BenchOptions& options);

/// Records the planning problems of a walk in closed loop, from the first step on and always with the horizon
/// of the configuration, so that every horizon is timed on the same problems; then times the planner over
/// them, in order and warm-started as on the robot, one thread. Rate and phases are means. Returns the exit
/// status: 0, or 1 when the robot fell in the recorded walk or a solve gave no plan. With
/// `closed_loop_plans` it does run_closed_loop_bench() instead. Throws UsageError.
[[nodiscard]] int run_bench(const BenchOptions& options);

}  // namespace stilt::cli
