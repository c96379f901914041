#pragma once

#include <span>
#include <type_traits>

#include "mpc_core/ocp/linearise_workspace.h"
#include "mpc_core/ocp/problem.h"

/// The quadratic model around an iterate after projection of the equality constraints (Gauss-Newton Hessian).
/// Fixed memory, no heap: real-time safe.
namespace stilt::ocp {

/// Outputs of a batch, one stage per lane; unused lanes repeat the last stage and write the same values.
struct BatchModel {
  lq::LqFirstOrder* first[kLanes];
  lq::LqSecondOrder* second[kLanes];
  InputProjection* inputs[kLanes];

  /// Addresses of one vector of each lane's stage. `member` selects the part that holds it.
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

/// Linearises the flow stages of up to kBatchesPerGroup batches of one contact mode.
void linearise(const ProblemData& data, std::span<const StageBatch> batches, const Trajectory& iterate,
               const BatchModel* to, LineariseWorkspace& work) noexcept;

/// Linearises the stages of a batch of transitions.
void linearise(const ProblemData& data, const TransitionBatch& batch, const Trajectory& iterate,
               const BatchModel& to) noexcept;

}  // namespace stilt::ocp
