#include <algorithm>
#include <cmath>

#include "mpc_core/model/debug_assert.h"
#include "mpc_core/ocp/barrier.h"
#include "mpc_core/ocp/batch_access.h"
#include "mpc_core/ocp/integrator.h"
#include "mpc_core/ocp/problem.h"
#include "mpc_core/ocp/projection.h"
#include "mpc_core/ocp/torque_limit.h"

namespace stilt::ocp {
namespace {

using model::kFeet;
using model::kFirstJoint;
using model::kInputs;
using model::kJoints;
using model::kPositions;
using model::kStates;

/// Sums over batches, one lane per stage; reduced at the end.
struct BatchMerit {
  Batch cost = Batch(0.0);
  Batch violation_squared = Batch(0.0);
  Batch dynamics_defect_max = Batch(0.0);
  Batch equality_violation_max = Batch(0.0);
};

Batch squared_error(const Batch& value, const Batch& reference) noexcept {
  const Batch error = value - reference;
  return error * error;
}

Batch quadratic_cost(const ProblemData& data, const StageBatch& batch, const BatchIterate& it,
                     const model::NodeTerms<Batch>& node) noexcept {
  Batch cost = Batch(0.0);
  for (int i = 0; i < kStates; ++i) cost += data.state_weight[i] * squared_error(it.x[i], batch.x_ref[i]);
  for (int i = 0; i < kInputs; ++i) cost += data.input_weight[i] * squared_error(it.u[i], batch.u_ref[i]);
  for (int i = 0; i < 2 * kFeet; ++i) {
    cost += data.cost.foot_position * squared_error(node.foot_position[i], batch.foot_position_ref[i]);
    cost += data.cost.foot_velocity * squared_error(node.foot_velocity[i], batch.foot_velocity_ref[i]);
    cost += data.cost.foot_acceleration *
            squared_error(node.foot_acceleration[i], batch.foot_acceleration_ref[i]);
  }
  return 0.5 * cost;
}

struct Barriers {
  BarrierConstants joint_position, joint_velocity, joint_torque, friction, impulse;

  explicit Barriers(const InequalityParameters& p) noexcept
      : joint_position(p.joint_position),
        joint_velocity(p.joint_velocity),
        joint_torque(p.joint_torque),
        friction(p.friction),
        impulse(p.impulse) {}
};

Batch barrier_cost(const ProblemData& data, const Barriers& barriers, const StageBatch& batch,
                   const BatchIterate& it, const model::NodeTerms<Batch>& node) noexcept {
  const InequalityParameters& p = data.inequality;
  BarrierSum position(barriers.joint_position);
  BarrierSum velocity(barriers.joint_velocity);
  BarrierSum torque(barriers.joint_torque);
  for (int j = 0; j < kJoints; ++j) {
    const Batch& q = it.x[kFirstJoint + j];
    const Batch& v = it.x[kPositions + kFirstJoint + j];
    position.add(q - data.limits.position_min_rad[j]);
    position.add(data.limits.position_max_rad[j] - q);
    velocity.add(data.limits.velocity_rad_s[j] + v);
    velocity.add(data.limits.velocity_rad_s[j] - v);
    const TorqueMargins margins(data.limits, j, node.joint_torque[j], v);
    torque.add(margins.lower);
    torque.add(margins.upper);
  }
  Batch cost = position.value() + velocity.value() + torque.value();
  if (batch.mode.count() > 0) {
    BarrierSum friction(barriers.friction);
    for (int foot = 0; foot < kFeet; ++foot) {
      if (!batch.mode[foot]) continue;
      const Batch& fx = it.u[kJoints + 2 * foot];
      const Batch& fz = it.u[kJoints + 2 * foot + 1];
      const Batch margin = p.friction_coefficient * (fz - data.minimum_normal_force_N(batch.mode));
      friction.add(margin + fx);
      friction.add(margin - fx);
    }
    cost += friction.value();
  }
  return cost;
}

void add_defects(const ProblemData& data, const StageBatch& batch, const BatchIterate& it,
                 const model::NodeTerms<Batch>& node, BatchMerit& merit) noexcept {
  BaseMotion motion;
  integrate_base(*data.robot, data.discretisation.integrator, it.x, it.u, batch.duration,
                 node.base_acceleration, motion);
  Batch reached[kStates];
  next_state(it.x, it.u, batch.duration, motion, reached);
  Batch sum = Batch(0.0);
  for (int i = 0; i < kStates; ++i) {
    const Batch defect = reached[i] - it.x_next[i];
    sum += defect * defect;
    merit.dynamics_defect_max = max(merit.dynamics_defect_max, abs(defect));
  }
  merit.violation_squared += batch.weight * sum;
}

void add_equalities(const ProblemData& data, const StageBatch& batch, const BatchIterate& it,
                    const model::NodeTerms<Batch>& node, BatchMerit& merit) noexcept {
  Batch sum = Batch(0.0);
  const auto add = [&](const Batch& residual) {
    sum += residual * residual;
    merit.equality_violation_max = max(merit.equality_violation_max, abs(residual));
  };
  for (int foot = 0; foot < kFeet; ++foot) {
    const bool stance = batch.mode[foot];
    const auto residual = [&](int axis) {
      return constraint_residual(data.equality, batch, stance, foot, axis, node.foot_position,
                                 node.foot_velocity, node.foot_acceleration);
    };
    add(residual(1));
    if (stance) {
      add(residual(0));
    } else {
      add(it.u[kJoints + 2 * foot]);
      add(it.u[kJoints + 2 * foot + 1]);
    }
  }
  merit.violation_squared += batch.weight * batch.duration * batch.duration * sum;
}

void add_transitions(const ProblemData& data, const Barriers& barriers, const BatchParameters& parameters,
                     const TransitionBatch& batch, const Trajectory& iterate, BatchMerit& merit) noexcept {
  const BatchTransition it(iterate, batch);
  model::KinematicsTerms<Batch> feet;
  data.robot->kinematics(it.x, feet);
  for (int foot = 0; foot < kFeet; ++foot) {
    if (!batch.touchdown[foot]) continue;
    const Batch& slip_m_s = feet.foot_velocity[2 * foot];
    merit.cost += batch.weight * (0.5 * data.cost.touchdown_velocity) * slip_m_s * slip_m_s;
  }
  Batch after[kStates];
  std::copy(it.x, it.x + kStates, after);
  if (data.discretisation.transition == Transition::impact) {
    model::ImpactTerms<Batch> impact;
    data.robot->impact(batch.mode, it.x, parameters.value, impact);
    std::copy(impact.velocity_after, impact.velocity_after + kPositions, after + kPositions);
    BarrierSum cone(barriers.impulse);
    for (int foot = 0; foot < kFeet; ++foot) {
      if (!batch.mode[foot]) continue;
      const Batch friction_Ns = data.inequality.friction_coefficient * impact.impulse[2 * foot + 1];
      cone.add(friction_Ns + impact.impulse[2 * foot]);
      cone.add(friction_Ns - impact.impulse[2 * foot]);
    }
    merit.cost += batch.weight * cone.value();
  }
  Batch sum = Batch(0.0);
  for (int i = 0; i < kStates; ++i) {
    const Batch defect = after[i] - it.x_next[i];
    sum += defect * defect;
    merit.dynamics_defect_max = max(merit.dynamics_defect_max, abs(defect));
  }
  merit.violation_squared += batch.weight * sum;
}

double terminal_cost(const ProblemData& data, const Problem& problem, const double* x) noexcept {
  double cost = 0.0;
  for (int c = 0; c < kStates; ++c) {
    double product = 0.0;
    for (int r = 0; r < kStates; ++r) {
      product += data.terminal_weight[c][r] * (x[r] - problem.x_ref_terminal[r]);
    }
    cost += 0.5 * product * (x[c] - problem.x_ref_terminal[c]);
  }
  return cost;
}

}  // namespace

Merit evaluate(const ProblemData& data, const Problem& problem, const Trajectory& iterate) noexcept {
  STILT_ASSERT(data.robot != nullptr && problem.batches + problem.transition_batches > 0);
  const BatchParameters parameters(data);
  const Barriers barriers(data.inequality);
  BatchMerit sums;
  for (int b = 0; b < problem.batches; ++b) {
    const StageBatch& batch = problem.batch[b];
    const BatchIterate it(iterate, batch);
    model::NodeTerms<Batch> node;
    data.robot->node(it.x, it.u, parameters.value, node);
    sums.cost += batch.weight * batch.duration *
                 (quadratic_cost(data, batch, it, node) + barrier_cost(data, barriers, batch, it, node));
    add_defects(data, batch, it, node, sums);
    add_equalities(data, batch, it, node, sums);
  }
  for (int b = 0; b < problem.transition_batches; ++b) {
    add_transitions(data, barriers, parameters, problem.transition_batch[b], iterate, sums);
  }

  Merit merit;
  merit.cost = reduce(sums.cost) + terminal_cost(data, problem, iterate.x[problem.horizon.stages]);
  merit.violation_squared = reduce(sums.violation_squared);
  merit.dynamics_defect_max = hmax(sums.dynamics_defect_max);
  merit.equality_violation_max = hmax(sums.equality_violation_max);
  return merit;
}

}  // namespace stilt::ocp
