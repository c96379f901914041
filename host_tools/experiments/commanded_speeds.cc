#include "host_tools/experiments/commanded_speeds.h"

#include "host_tools/experiments/table_text.h"
#include "host_tools/experiments/walks.h"
#include "host_tools/simulation/plant/number.h"

namespace stilt::experiments {
namespace {

Json run_job(const SpeedPlan& plan, double speed_m_s, const WalkRunner& run) {
  WalkCase walk;
  walk.controller = plan.controller;
  walk.horizon_s = plan.horizon_s;
  walk.command = {gait::GaitKind::walk, speed_m_s};
  walk.duration_s = plan.duration_s;
  const log::RunSummary summary = run(walk).summary;
  return {
      {"controller", plan.controller},
      {"horizon_s", plan.horizon_s},
      {"duration_s", plan.duration_s},
      {"speed_m_s", speed_m_s},
      {"survived", summary.survived},
      {"mean_speed_m_s", summary.mean_speed_m_s},
      {"walks", walks(walk.command, summary)},
      {"peak_torque_Nm", std::vector<double>(summary.peak_torque_Nm.begin(), summary.peak_torque_Nm.end())},
      {"heap_allocations_in_loop", summary.heap_allocations_in_loop}};
}

}  // namespace

std::vector<Job> speed_jobs(const SpeedPlan& plan, const WalkRunner& run) {
  std::vector<Job> jobs;
  for (const double speed_m_s : plan.speeds_m_s) {
    jobs.push_back(
        {"speed_" + simulation::decimals_text(speed_m_s), [=] { return run_job(plan, speed_m_s, run); }});
  }
  return jobs;
}

Json merge_speeds(const std::vector<Json>& results) { return {{"rows", results}}; }

std::string speed_table(const Json& merged) {
  std::string table =
      "| commanded m/s | mean m/s | walks | heap allocations in the loop |\n"
      "|---|---|---|---|\n";
  for (const Json& row : merged.at("rows")) {
    table += "| " + simulation::decimals_text(row.at("speed_m_s")) + " | " +
             (row.at("survived").get<bool>() ? cell(row.at("mean_speed_m_s"), "%.3f") : "falls") + " | " +
             (row.at("walks").get<bool>() ? "yes" : "no") + " | " +
             row.at("heap_allocations_in_loop").dump() + " |\n";
  }
  return table;
}

}  // namespace stilt::experiments
