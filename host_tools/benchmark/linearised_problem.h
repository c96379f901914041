#pragma once

#include <vector>

#include "host_tools/benchmark/lq_stage.h"
#include "mpc_core/ocp/stage_models.h"

namespace stilt::benchmark {

/// Linearises all stages in the order of the backward sweep.
inline void linearise_all(ocp::StageModels& models, const ocp::ProblemData& data, const ocp::Problem& problem,
                          const ocp::Trajectory& iterate) noexcept {
  models.begin(data, problem, iterate);
  for (int k = problem.horizon.stages - 1; k >= 0; --k) {
    const ocp::StageModel model = models.at(k);
    asm volatile("" : : "r"(&model.first), "r"(&model.second) : "memory");
  }
}

/// The quadratic model of a whole horizon: the data that a backward sweep reads from StageModels, stored.
struct LinearisedProblem {
  std::vector<LqStage> stages;
  std::vector<ocp::InputProjection> projections;
  lq::LqTerminal terminal;

  LinearisedProblem(ocp::StageModels& models, const ocp::ProblemData& data, const ocp::Problem& problem,
                    const ocp::Trajectory& iterate)
      : stages(static_cast<std::size_t>(problem.horizon.stages)) {
    models.begin(data, problem, iterate);
    for (int k = problem.horizon.stages - 1; k >= 0; --k) {
      const ocp::StageModel model = models.at(k);
      stages[static_cast<std::size_t>(k)] = {model.first, model.second};
    }
    projections.assign(models.inputs(), models.inputs() + problem.horizon.stages);
    terminal = models.terminal();
  }

  /// The inputs of the forward sweep, in order.
  [[nodiscard]] std::vector<lq::LqFirstOrder> first_orders() const { return {stages.begin(), stages.end()}; }
};

}  // namespace stilt::benchmark
