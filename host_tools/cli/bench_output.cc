#include "host_tools/cli/bench_output.h"

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "host_tools/cli/json_output.h"
#include "host_tools/simulation/closed_loop/run_recorder.h"

namespace stilt::cli {
namespace {

using Json = nlohmann::ordered_json;
using benchmark::PhaseSpeed;
using benchmark::PhaseSpeeds;

double mean(const std::vector<double>& values) {
  if (values.empty()) return 0.0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double maximum(const std::vector<double>& values) {
  return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

bool is_counted(const PhaseSpeed& speed) { return speed.work.instructions > 0; }

Json phase_json(const PhaseSpeed& speed) {
  const bool counted = is_counted(speed);
  const auto if_counted = [&](auto value) { return counted ? Json(value) : Json(nullptr); };
  return {{"time_us", speed.time_us},
          {"instructions", if_counted(speed.work.instructions)},
          {"flops", if_counted(speed.work.flops)},
          {"rate_gflop_s", if_counted(speed.rate_gflop_s)},
          {"peak_share", if_counted(speed.peak_share)}};
}

Json speeds_json(const PhaseSpeeds& s) {
  return {{"isa", model::name_of(dispatch::instruction_set_of_build())},
          {"peak_gflop_s", s.peak_gflop_s},
          {"linearise", phase_json(s.linearise)},
          {"riccati", phase_json(s.sweep)},
          {"line_search_trial", phase_json(s.evaluate)},
          {"riccati_textbook_peak_share", s.textbook_sweep_share}};
}

void print_phase(const char* name, const PhaseSpeed& speed) {
  std::printf("  %-12s %7.1f us", name, speed.time_us);
  if (is_counted(speed)) {
    std::printf(", %5.0f kflop, %5.1f Gflop/s, %4.1f %% of the peak, %.2f Minstructions",
                1e-3 * static_cast<double>(speed.work.flops), speed.rate_gflop_s, 100.0 * speed.peak_share,
                1e-6 * static_cast<double>(speed.work.instructions));
  }
  std::printf("\n");
}

}  // namespace

Json bench_json(const PlannerTimings& timings, const PhaseSpeeds& speeds) {
  Json json;
  json["nodes"] = timings.nodes_max;
  json["solve_us"] = to_json(simulation::percentiles(timings.solve_us));
  json["rate_hz"] = 1e6 / mean(timings.solve_us);
  json["phases_us"] = {{"linearise", mean(timings.linearise_us)},
                       {"riccati", mean(timings.riccati_us)},
                       {"line_search", mean(timings.line_search_us)},
                       {"other", mean(timings.other_us)}};
  json["iterations"] = {{"mean", mean(timings.iterations)},
                        {"max", static_cast<int>(maximum(timings.iterations))}};
  json["isa"] = timings.instruction_set;
  json["threads"] = 1;
  json["problems"] = timings.solve_us.size();
  json["failed"] = timings.failed;
  json["kernels"] = speeds_json(speeds);
  return json;
}

void print_bench(const PlannerTimings& timings, const PhaseSpeeds& s, double horizon_s) {
  const log::Percentiles solve_us = simulation::percentiles(timings.solve_us);
  std::printf("planner        %zu problems of a walk, horizon %.2f s, at most %d nodes, %s, 1 thread\n",
              timings.solve_us.size(), horizon_s, timings.nodes_max, timings.instruction_set.c_str());
  std::printf("solve          p50 %.0f, p99 %.0f, max %.0f us; %.0f solves per second on average\n",
              solve_us.p50, solve_us.p99, solve_us.max, 1e6 / mean(timings.solve_us));
  std::printf("phases         linearise %.0f, riccati %.0f, line search %.0f, other %.0f us on average\n",
              mean(timings.linearise_us), mean(timings.riccati_us), mean(timings.line_search_us),
              mean(timings.other_us));
  std::printf("iterations     %.1f on average, %.0f at most; %d solves gave no plan\n",
              mean(timings.iterations), maximum(timings.iterations), timings.failed);
  std::printf("each once      medians on the last problem, %s; the core's peak is %.1f Gflop/s\n",
              model::name_of(dispatch::instruction_set_of_build()).data(), s.peak_gflop_s);
  print_phase("linearise", s.linearise);
  print_phase("riccati", s.sweep);
  print_phase("trial step", s.evaluate);
}

}  // namespace stilt::cli
