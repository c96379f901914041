#include "host_tools/benchmark/plan_sample.h"

#include <algorithm>
#include <cmath>

namespace stilt::benchmark {

void describe_work(const control::Planner& planner, const sqp::SolveReport& report, WorkTable& table,
                   PlanSample& sample) {
  const ocp::Problem& problem = planner.problem();
  sample.stages = problem.horizon.stages;
  for (int k = 0; k < sample.stages; ++k) {
    const ocp::Stage& stage = problem.horizon.stage[static_cast<std::size_t>(k)];
    if (stage.kind == ocp::StageKind::transition) {
      ++sample.transitions;
    } else if (stage.mode.count() == 2) {
      ++sample.double_support_stages;
    }
  }
  sample.iterations = report.iterations;
  sample.trial_steps = report.trial_steps;
  const long long evaluations = report.trial_steps + 1;  // plus the one of the initial guess
  const IterationWork work = table.work_of(planner);
  sample.instructions = report.iterations * (work.linearise.instructions + work.sweep.instructions) +
                        evaluations * work.evaluate.instructions;
}

Tail tail(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
    return values[std::max<std::size_t>(rank, 1) - 1];
  };
  return {at(0.5), at(0.99), at(0.999), values.back()};
}

std::vector<PlanSample> worst(std::vector<PlanSample> samples, std::size_t count) {
  std::stable_sort(samples.begin(), samples.end(),
                   [](const PlanSample& a, const PlanSample& b) { return a.instructions > b.instructions; });
  samples.resize(std::min(count, samples.size()));
  return samples;
}

}  // namespace stilt::benchmark
