#pragma once

#include "mpc_core/ocp/clock.h"
#include "mpc_core/ocp/linearise.h"

namespace stilt::ocp {

/// Quadratic model of one stage.
struct StageModel {
  const lq::LqFirstOrder& first;
  const lq::LqSecondOrder& second;
};

/// The quadratic model of all stages of a horizon, for a sweep from the last stage to the first. When the
/// sweep reaches the last stage of a batch, the batch is linearised with up to kBatchesPerGroup - 1 earlier
/// batches of its contact mode. The sweep then reads from a near cache, and few Hessians are kept at a time.
/// Fixed memory, no heap: real-time safe.
class StageModels {
 public:
  /// Starts a pass and writes the terminal cost. The arguments must outlive the pass.
  void begin(const ProblemData& data, const Problem& problem, const Trajectory& iterate) noexcept;

  /// Model of stage k. Call it for every stage, in descending order. `second` is valid until the next call,
  /// `first` until the next pass.
  [[nodiscard]] StageModel at(int k) noexcept {
    const StagePlace& place = problem_->place[k];
    if (place.batch < linearised_from_[place.group]) linearise_group(k);
    return {stages_[k], hessians(place.group, place.batch)[place.lane]};
  }

  /// Results of the whole pass: stages in ascending order, projections of their inputs, the terminal cost.
  [[nodiscard]] const lq::LqFirstOrder* stages() const noexcept { return stages_; }
  [[nodiscard]] const InputProjection* inputs() const noexcept { return projections_; }
  [[nodiscard]] const lq::LqTerminal& terminal() const noexcept { return terminal_; }

  /// Sets the clock of linearising_ns() from the next pass on. Null: nothing is measured.
  void set_clock(ClockFunction clock) noexcept { clock_ = clock; }
  /// Time spent in linearising during this pass, ns.
  [[nodiscard]] long long linearising_ns() const noexcept { return linearising_ns_; }

 private:
  /// Linearises the batch whose last stage is k, and earlier batches of its group.
  void linearise_group(int k) noexcept;
  void linearise_batches(int k) noexcept;
  template <class AnyBatch>
  [[nodiscard]] BatchModel output_of(const AnyBatch& batch, int group, int index) noexcept;
  [[nodiscard]] lq::LqSecondOrder* hessians(int group, int batch) noexcept {
    return hessians_[group][batch % kBatchesPerGroup];
  }

  const ProblemData* data_ = nullptr;
  const Problem* problem_ = nullptr;
  const Trajectory* iterate_ = nullptr;
  ClockFunction clock_ = nullptr;
  long long linearising_ns_ = 0;
  int linearised_from_[kGroups];  ///< first batch of each group that this pass has linearised
  lq::LqFirstOrder stages_[kMaxStages];
  lq::LqSecondOrder hessians_[kGroups][kBatchesPerGroup][kLanes];  ///< of the newest batches
  InputProjection projections_[kMaxStages];
  lq::LqTerminal terminal_;
  LineariseWorkspace work_;
};

}  // namespace stilt::ocp
