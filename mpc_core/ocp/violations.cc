#include <algorithm>

#include "mpc_core/model/debug_assert.h"
#include "mpc_core/ocp/batch_access.h"
#include "mpc_core/ocp/problem.h"
#include "mpc_core/ocp/torque_limit.h"

namespace stilt::ocp {
namespace {

using model::kFeet;
using model::kFirstJoint;
using model::kJoints;
using model::kPositions;

/// Largest violations so far, one lane per stage.
struct BatchViolations {
  Batch friction_cone = Batch(0.0);
  Batch pulling_force = Batch(0.0);
  Batch impulse_cone = Batch(0.0);
  Batch joint_torque = Batch(0.0);
  Batch joint_position = Batch(0.0);
  Batch joint_velocity = Batch(0.0);
};

void raise(Batch& largest, const Batch& violation) noexcept { largest = max(largest, violation); }

void check_joints(const JointLimits& limits, const BatchIterate& it, const model::NodeTerms<Batch>& node,
                  BatchViolations& largest) noexcept {
  for (int j = 0; j < kJoints; ++j) {
    const Batch& q = it.x[kFirstJoint + j];
    const Batch& v = it.x[kPositions + kFirstJoint + j];
    raise(largest.joint_position, limits.position_min_rad[j] - q);
    raise(largest.joint_position, q - limits.position_max_rad[j]);
    raise(largest.joint_velocity, abs(v) - limits.velocity_rad_s[j]);
    // Beyond its no-load speed a drive still gives no torque: its limits there are 0.
    const TorqueMargins margins(limits, j, node.joint_torque[j], v);
    raise(largest.joint_torque, min(-margins.lower, -node.joint_torque[j]));
    raise(largest.joint_torque, min(-margins.upper, node.joint_torque[j]));
  }
}

void check_forces(const ProblemData& data, const StageBatch& batch, const BatchIterate& it,
                  BatchViolations& largest) noexcept {
  for (int foot = 0; foot < kFeet; ++foot) {
    if (!batch.mode[foot]) continue;
    const Batch& fx = it.u[kJoints + 2 * foot];
    const Batch& fz = it.u[kJoints + 2 * foot + 1];
    raise(largest.friction_cone, abs(fx) - data.inequality.friction_coefficient * max(fz, Batch(0.0)));
    raise(largest.pulling_force, -fz);
  }
}

void check_impulses(const ProblemData& data, const BatchParameters& parameters, const TransitionBatch& batch,
                    const Trajectory& iterate, BatchViolations& largest) noexcept {
  const BatchTransition it(iterate, batch);
  model::ImpactTerms<Batch> impact;
  data.robot->impact(batch.mode, it.x, parameters.value, impact);
  for (int foot = 0; foot < kFeet; ++foot) {
    if (!batch.mode[foot]) continue;
    raise(largest.impulse_cone, abs(impact.impulse[2 * foot]) -
                                    data.inequality.friction_coefficient * impact.impulse[2 * foot + 1]);
  }
}

}  // namespace

Violations violations(const ProblemData& data, const Problem& problem, const Trajectory& iterate) noexcept {
  STILT_ASSERT(data.robot != nullptr && problem.batches > 0);
  const BatchParameters parameters(data);
  BatchViolations largest;
  for (int b = 0; b < problem.batches; ++b) {
    const StageBatch& batch = problem.batch[b];
    const BatchIterate it(iterate, batch);
    model::NodeTerms<Batch> node;
    data.robot->node(it.x, it.u, parameters.value, node);
    check_joints(data.limits, it, node, largest);
    check_forces(data, batch, it, largest);
  }
  if (data.discretisation.transition == Transition::impact) {
    for (int b = 0; b < problem.transition_batches; ++b)
      check_impulses(data, parameters, problem.transition_batch[b], iterate, largest);
  }
  return {.friction_cone_violation_max_N = hmax(largest.friction_cone),
          .pulling_force_max_N = hmax(largest.pulling_force),
          .impulse_cone_violation_max_Ns = hmax(largest.impulse_cone),
          .torque_violation_max_Nm = hmax(largest.joint_torque),
          .position_violation_max_rad = hmax(largest.joint_position),
          .velocity_violation_max_rad_s = hmax(largest.joint_velocity)};
}

}  // namespace stilt::ocp
