#pragma once

#include "mpc_core/ocp/integrator.h"
#include "mpc_core/ocp/quadratic_cost.h"

namespace stilt::ocp {

/// Batches of a contact mode that are linearised together, one step of the work after the other: its code,
/// far larger than the instruction cache as a whole, then comes from the next level once for all of them.
inline constexpr int kBatchesPerGroup = 4;

/// The eliminations of both kinds for one batch.
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

/// Room for the eliminations of one batch, whatever its mode.
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

/// Everything linearise() writes besides its results, so that it needs little stack; contents need not be
/// initialised.
struct LineariseWorkspace {
  struct Flow {
    BatchIterate it;
    model::NodeDerivatives<Batch> node;
    BaseStep step;
    AnyEliminations eliminations;
    QuadraticCost cost;
  };
  Flow flow[kBatchesPerGroup];
  IntegratorWorkspace integrator;
};

}  // namespace stilt::ocp
