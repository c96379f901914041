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

using lq::InputProjection;

/// Quantities that the line search compares.
struct Merit {
  double cost = 0.0;
  double violation_squared = 0.0;  ///< defects^2 + (duration * equality residual)^2, summed
  double dynamics_defect_max = 0.0;
  double equality_violation_max = 0.0;
};

}  // namespace stilt::ocp
