#pragma once

#include <algorithm>
#include <cstddef>

#include "mpc_core/ocp/integrator.h"
#include "mpc_core/ocp/quadratic_cost.h"

namespace stilt::ocp {

/// Batches of a contact mode that are linearised together, one step of the work after the other: its code,
/// far larger than the instruction cache as a whole, then comes from the next level once for all of them.
inline constexpr int kTogether = 4;

/// The eliminations of both kinds for one batch.
template <class Mode>
struct Eliminations {
  ForceElimination<Mode> force;
  ConstraintElimination<Mode> constraint;

  Eliminations(const EqualityParameters& parameters, const StageBatch& batch, const Batch* u,
               const model::NodeDerivatives<Batch>& node) noexcept
      : force(parameters, batch, u, node), constraint(parameters, batch, node, force) {}
};

/// Everything linearise() writes besides its results, so that it needs little stack; contents need not be
/// initialised.
struct LineariseWorkspace {
  struct Flow {
    BatchIterate it;
    model::NodeDerivatives<Batch> node;
    BaseStep step;
    QuadraticCost cost;
    alignas(64) std::byte eliminations[std::max({sizeof(Eliminations<ModeTraits<true, true>>),
                                                 sizeof(Eliminations<ModeTraits<true, false>>),
                                                 sizeof(Eliminations<ModeTraits<false, false>>)})];
  };
  Flow flow[kTogether];
  IntegratorWorkspace integrator;
};

}  // namespace stilt::ocp
