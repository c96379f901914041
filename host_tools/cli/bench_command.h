#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "host_tools/cli/controller_choice.h"

namespace stilt::cli {

/// Options of `stilt bench`.
struct BenchOptions {
  ControllerChoice choice;
  int problems = 400;
  int closed_loop_plans = 0;  ///< 0: times the recorded problems instead
  double speed_m_s = 0.5;
  std::vector<std::string> pushes;  ///< of the closed loop
  std::string json_file;
};

/// Adds `bench` to the program and stores its options in `options`.
CLI::App* add_bench_command(CLI::App& program, BenchOptions& options);

/// Records the planning problems of a walk in closed loop, after its first 3 s. The walk always uses the
/// horizon of the configuration, so that every horizon is timed on the same problems. Then times the planner
/// over them, in order and warm-started as on the robot, with one thread. Rate and phases are means. With
/// `closed_loop_plans` it runs run_closed_loop_bench() instead. Returns the exit status: 0, or 1 when the
/// robot fell in the recorded walk or a solve gave no plan. Throws UsageError.
[[nodiscard]] int run_bench(const BenchOptions& options);

}  // namespace stilt::cli
