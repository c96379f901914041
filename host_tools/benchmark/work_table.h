#pragma once

#include <map>
#include <optional>
#include <utility>

#include "host_tools/benchmark/linearised_problem.h"
#include "host_tools/benchmark/step_counter.h"
#include "mpc_core/control/planner.h"

namespace stilt::benchmark {

/// Work of the phases of one SQP iteration, each executed once.
struct IterationWork {
  ExecutedWork linearise;
  ExecutedWork sweep;     ///< backward and forward
  ExecutedWork evaluate;  ///< one trial step of the line search
};

/// Work of the phases by their parts: batches of a contact mode, touch-downs, stages by number of free
/// inputs. A part executes nearly the same instructions for all numbers. It is therefore single-stepped,
/// which is slow, only at its first occurrence; the sum is accurate to half a per cent.
class WorkTable {
 public:
  /// Work for the last problem of the planner.
  [[nodiscard]] IterationWork work_of(const control::Planner& planner);

 private:
  using Feet = std::pair<bool, bool>;
  struct Parts {
    std::optional<ExecutedWork> fixed;
    std::map<std::pair<Feet, int>, ExecutedWork> batch;      ///< by feet on the ground and lanes in use
    std::map<std::pair<Feet, int>, ExecutedWork> touchdown;  ///< by feet that touch down and lanes in use
  };

  template <class Kernel>
  [[nodiscard]] ExecutedWork sum_of(Parts& parts, const ocp::Problem& whole, const Kernel& kernel);
  [[nodiscard]] ExecutedWork sweep_of(const ocp::StageModel& stage, const ocp::InputProjection& inputs);
  /// Makes part_ a problem of `count` batches like `batch` of the whole; `batches` are those of part_.
  template <class AnyBatch>
  void repeat(const ocp::Problem& whole, const AnyBatch& batch, int count, AnyBatch* batches, int& size);

  Parts linearise_, evaluate_;
  std::map<int, ExecutedWork> sweep_;  ///< by free inputs
  ExecutedWork empty_sweep_;
  ocp::Problem part_;  ///< problem with some batches of the whole
  ocp::StageModels models_;
  lq::RiccatiWorkspace workspace_;
};

}  // namespace stilt::benchmark
