#include "host_tools/benchmark/call_counter.h"

#include <utility>

namespace stilt::benchmark {
namespace {

using model::Batch;

// The functions of a model are plain pointers: what they count cannot belong to an object.
ModelCalls calls;
model::RobotFunctions<Batch> counted;
model::RobotModel counting;

}  // namespace

const model::RobotModel& counting_model(const model::RobotModel& robot) {
  counted = robot.batch;
  counting = robot;
  counting.batch.node = [](const Batch* x, const Batch* u, const Batch* p,
                           model::NodeTerms<Batch>& out) noexcept {
    ++calls.evaluated_batches;
    counted.node(x, u, p, out);
  };
  counting.batch.node_derivatives = [](const Batch* x, const Batch* u, const Batch* p,
                                       model::NodeDerivatives<Batch>& out) noexcept {
    ++calls.linearised_batches;
    counted.node_derivatives(x, u, p, out);
  };
  return counting;
}

ModelCalls take_model_calls() noexcept { return std::exchange(calls, {}); }

}  // namespace stilt::benchmark
