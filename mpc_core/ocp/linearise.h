#pragma once

#include <span>
#include <type_traits>

#include "mpc_core/ocp/linearise_workspace.h"
#include "mpc_core/ocp/problem.h"

/// The quadratic model around an iterate, equalities projected out (Gauss-Newton Hessian). Fixed memory, no
/// heap: real-time safe.
namespace stilt::ocp {

/// Where the model of each lane's stage goes; unused lanes repeat the last one and write the same.
struct BatchModel {
  lq::LqFirstOrder* first[kLanes];
  lq::LqSecondOrder* second[kLanes];
  InputProjection* inputs[kLanes];

  /// Where one vector of each lane's stage lies. `member` takes the part that has it.
  template <class Member>
  void rows(const Member& member, double* (&out)[kLanes]) const noexcept {
    for (int lane = 0; lane < kLanes; ++lane) {
      if constexpr (std::is_invocable_v<Member, lq::LqFirstOrder&>) {
        out[lane] = member(*first[lane]);
      } else if constexpr (std::is_invocable_v<Member, lq::LqSecondOrder&>) {
        out[lane] = member(*second[lane]);
      } else {
        out[lane] = member(*inputs[lane]);
      }
    }
  }
};

/// The stages of up to kBatchesPerGroup batches of one contact mode.
void linearise(const ProblemData& data, std::span<const StageBatch> batches, const Trajectory& iterate,
               const BatchModel* to, LineariseWorkspace& work) noexcept;

/// Those of a batch of transitions.
void linearise(const ProblemData& data, const TransitionBatch& batch, const Trajectory& iterate,
               const BatchModel& to, LineariseWorkspace& work) noexcept;

}  // namespace stilt::ocp
