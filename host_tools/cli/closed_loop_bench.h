#pragma once

#include "host_tools/cli/bench_command.h"

namespace stilt::cli {

/// Times `options.closed_loop_plans` consecutive plans of a walk in closed loop, with all iterations used.
/// Reports the ratio of the longest to the median, in time and in instructions; other programs do not affect
/// instructions. Returns the exit status: 0, or 1 when the robot fell.
[[nodiscard]] int run_closed_loop_bench(const BenchOptions& options);

}  // namespace stilt::cli
