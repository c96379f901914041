#pragma once

#include "mpc_core/lq/lq_problem.h"
#include "mpc_core/ocp/horizon.h"

namespace stilt::ocp {

/// States at the nodes and inputs of the stages: the iterate of the SQP. Rows are padded to whole cache
/// lines.
struct alignas(64) Trajectory {
  double x[kMaxNodes][lq::kRows];
  double u[kMaxStages][model::kInputs];
};

/// Step of the input as a function of the step of the state and of the free directions:
///
///   du = u0 + Y c + W w + [0; F dx; 0]
///
/// c are the products of the stage's constraint rows with dx (LqStep::c). F are the rows of the force that
/// the stance constraint fixes, at u[first_force] and the next entry. Columns of eight inputs.
struct alignas(64) InputProjection {
  double u0[model::kInputs];
  double Y[lq::kMaxConstraints][model::kInputs];
  double W[lq::kMaxFreeInputs][model::kInputs];
  double F[2][lq::kRows];
  double u0_slope;  ///< first-order change of the stage's cost along u0
  int first_force;  ///< -1: no foot on the ground, or no flow
};

/// Quantities that the line search compares.
struct Merit {
  double cost = 0.0;
  double violation_squared = 0.0;  ///< defects^2 + (duration * equality residual)^2, summed
  double defect_max = 0.0;
  double equality_max = 0.0;
};

}  // namespace stilt::ocp
