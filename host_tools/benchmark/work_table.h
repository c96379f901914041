#pragma once

#include <map>
#include <optional>
#include <utility>

#include "host_tools/benchmark/linearised_problem.h"
#include "host_tools/benchmark/step_counter.h"
#include "mpc_core/control/planner.h"

namespace stilt::benchmark {

/// What the phases of one SQP iteration execute, each once.
struct IterationWork {
  ExecutedWork linearise;
  ExecutedWork sweep;     ///< backward and forward
  ExecutedWork evaluate;  ///< one trial step of the line search
};

/// Work of the phases by their parts: batches of a contact mode, touch-downs, stages by number of free
/// inputs. Each part executes nearly the same instructions whatever its numbers are, so that it is stepped
/// through once (which is slow), when it first turns up; the sum is right to half a per cent.
class WorkTable {
 public:
  /// For the problem that the planner solved last.
  [[nodiscard]] IterationWork work_of(const control::Planner& planner);

 private:
  using Feet = std::pair<bool, bool>;
  struct Parts {
    std::optional<ExecutedWork> fixed;
    std::map<std::pair<Feet, int>, ExecutedWork> batch;      ///< by feet on the ground and lanes in use
    std::map<std::pair<Feet, int>, ExecutedWork> touchdown;  ///< by feet that land and lanes in use
  };

  template <class Kernel>
  [[nodiscard]] ExecutedWork sum_of(Parts& parts, const ocp::Problem& whole, const Kernel& kernel);
  [[nodiscard]] ExecutedWork sweep_of(const ocp::StageModel& stage);
  /// Makes part_ a problem of `count` batches like this one of the whole; `batches` are those of part_.
  template <class AnyBatch>
  void repeat(const ocp::Problem& whole, const AnyBatch& batch, int count, AnyBatch* batches, int& size);

  Parts linearise_, evaluate_;
  std::map<int, ExecutedWork> sweep_;  ///< by free inputs
  ExecutedWork empty_sweep_;
  ocp::Problem part_;  ///< a part of the problem
  ocp::StageModels models_;
  lq::RiccatiWorkspace workspace_;
};

}  // namespace stilt::benchmark
