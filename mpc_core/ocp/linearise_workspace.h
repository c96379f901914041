#pragma once

#include "mpc_core/ocp/integrator.h"
#include "mpc_core/ocp/quadratic_cost.h"

namespace stilt::ocp {

/// Everything linearise() writes besides its results, so that it needs little stack; contents need not be
/// initialised.
struct LineariseWorkspace {
  model::NodeDerivatives<Batch> node;
  BaseStep step;
  IntegratorWorkspace integrator;
  QuadraticCost cost;
};

}  // namespace stilt::ocp
