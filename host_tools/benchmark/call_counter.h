#pragma once

#include "mpc_core/model/robot.h"

namespace stilt::benchmark {

/// Calls of the generated functions that the solver makes once for every batch of stages.
struct ModelCalls {
  long long linearised_batches = 0;  ///< of flow stages and of transitions
  long long evaluated_batches = 0;   ///< of flow stages
};

/// A model that computes what `robot` does and counts. There is one at a time: a later call takes its place.
/// Count in one thread only.
[[nodiscard]] const model::RobotModel& counting_model(const model::RobotModel& robot);

/// Calls since the last time this was asked.
[[nodiscard]] ModelCalls take_model_calls() noexcept;

}  // namespace stilt::benchmark
