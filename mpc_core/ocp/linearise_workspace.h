#pragma once

#include "mpc_core/ocp/integrator.h"
#include "mpc_core/ocp/quadratic_cost.h"

namespace stilt::ocp {

/// Number of batches of a contact mode that are linearised together, step by step. The code is far larger
/// than the instruction cache; each step is then loaded once for all of them. With eight lanes two batches
/// take the time of four, and the memory of four with four lanes.
inline constexpr int kBatchesPerGroup = kLanes < 8 ? 4 : 2;

/// The force elimination and the constraint elimination of one batch.
template <class Mode>
struct Eliminations {
  ForceElimination<Mode> force;
  ConstraintElimination<Mode> constraint;

  void eliminate(const EqualityParameters& parameters, const StageBatch& batch, const Batch* u,
                 const model::NodeDerivatives<Batch>& node) noexcept {
    force.eliminate(parameters, batch, u, node);
    constraint.eliminate(parameters, batch, node, force);
  }
};

/// Memory for the eliminations of one batch of any mode.
union AnyEliminations {
  Eliminations<ModeTraits<true, true>> both;
  Eliminations<ModeTraits<true, false>> left;
  Eliminations<ModeTraits<false, true>> right;
  Eliminations<ModeTraits<false, false>> none;

  AnyEliminations() noexcept {}

  template <class Mode>
  [[nodiscard]] Eliminations<Mode>& of() noexcept {
    if constexpr (Mode::kStanceFeet == 2) {
      return both;
    } else if constexpr (Mode::stance(0)) {
      return left;
    } else if constexpr (Mode::stance(1)) {
      return right;
    } else {
      return none;
    }
  }
};

/// Scratch of linearise(), kept off the stack; contents need not be initialised. What one step of the work
/// makes and the same step uses is there once, so that it stays in the nearest cache.
struct LineariseWorkspace {
  struct Flow {
    BatchIterate it;
    model::NodeDerivatives<Batch> node;
    AnyEliminations eliminations;
  };
  Flow flow[kBatchesPerGroup];
  BaseStep step;
  QuadraticCost cost;
  IntegratorWorkspace integrator;
};

}  // namespace stilt::ocp
