#include "host_tools/recording/run_clock.h"

namespace stilt::log {

void count_from(RunRecord& record, double start_s) {
  for (RunSample& sample : record.samples) sample.time_s += start_s;
  for (MissingTicks& missing : record.missing_ticks) {
    missing.from_s += start_s;
    missing.to_s += start_s;
  }
  for (SolveSample& solve : record.solves) solve.time_s += start_s;
  for (PlanSnapshot& plan : record.plans) {
    plan.time_s += start_s;
    for (double& node_s : plan.node_time_s) node_s += start_s;
  }
  for (Step& step : record.summary.steps) step.time_s += start_s;
  if (record.summary.fall_time_s >= 0.0) record.summary.fall_time_s += start_s;
}

}  // namespace stilt::log
