#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host_tools/benchmark/phase_speeds.h"

namespace stilt::cli {

/// Times of a planner over a list of problems: one list per quantity, one entry per problem.
struct PlannerTimings {
  std::string instruction_set;
  std::vector<double> solve_us, linearise_us, riccati_us, line_search_us, other_us, iterations;
  int nodes_max = 0;
  int failed = 0;
};

/// The JSON of `stilt bench`; `speeds` are of the planner for the build's instruction set. When
/// `speeds.linearise.work` has no instructions, the work cannot be counted on this processor; operations and
/// rates are then null.
[[nodiscard]] nlohmann::ordered_json bench_json(const PlannerTimings& timings,
                                                const benchmark::PhaseSpeeds& speeds);

/// Prints the same as text on standard output.
void print_bench(const PlannerTimings& timings, const benchmark::PhaseSpeeds& speeds, double horizon_s);

}  // namespace stilt::cli
