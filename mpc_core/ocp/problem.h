#pragma once

#include "mpc_core/gait/reference.h"
#include "mpc_core/model/batch.h"
#include "mpc_core/ocp/problem_data.h"
#include "mpc_core/ocp/trajectory.h"
#include "mpc_core/ocp/violations.h"

/// One planning problem: horizon, references and weights, stored for batched evaluation.
namespace stilt::ocp {

using model::Batch;
using model::kLanes;

/// Up to kLanes flow stages with the same feet on the ground, with all their data that is constant during the
/// solve. Unused lanes repeat the last stage with weight 0.
struct StageBatch {
  model::ContactMode mode;
  int lanes = 0;
  int stage[kLanes] = {};
  Batch weight;    ///< 1 for used lanes, 0 for unused ones
  Batch duration;  ///< s
  Batch x_ref[model::kStates];
  Batch u_ref[model::kInputs];
  Batch foot_position_ref[2 * model::kFeet];
  Batch foot_velocity_ref[2 * model::kFeet];
  Batch foot_acceleration_ref[2 * model::kFeet];
};

/// Each contact mode can leave one batch partly filled.
inline constexpr int kMaxBatches = (kMaxStages + kLanes - 1) / kLanes + 4;

/// Up to kLanes transitions with the same feet touching down. Unused lanes repeat the last stage with weight
/// 0.
struct TransitionBatch {
  std::array<bool, model::kFeet> touchdown{};
  int lanes = 0;
  int stage[kLanes] = {};
  Batch weight;
};

/// Left, right and both feet can each leave one batch partly filled, and so can transitions without a
/// touch-down.
inline constexpr int kMaxTransitionBatches = (kMaxSwitches + kLanes - 1) / kLanes + 4;

/// Groups of stages that share batches: flows of a contact mode (0 to 3), transitions with the same feet
/// touching down (4 to 7). The batches of a group are consecutive, in the horizon and in memory.
inline constexpr int kGroups = 8;

/// Position of a stage in the batches of its kind.
struct StagePlace {
  int batch = 0;
  int group = 0;
  int lane = 0;
};

/// Horizon, references and initial state of one plan.
struct Problem {
  Horizon horizon;
  int batches = 0;
  StageBatch batch[kMaxBatches];
  int transition_batches = 0;
  TransitionBatch transition_batch[kMaxTransitionBatches];
  StagePlace place[kMaxStages];
  alignas(64) double x_initial[lq::kRows] = {};
  alignas(64) double x_ref_terminal[lq::kRows] = {};
};

/// Sorts the stages of the horizon into batches and evaluates the reference at each.
void fill_batches(const gait::HeuristicReference& reference, Problem& problem) noexcept;

/// Violations of the inequalities by an iterate.
[[nodiscard]] Violations violations(const ProblemData& data, const Problem& problem,
                                    const Trajectory& iterate) noexcept;

/// Merit of an iterate: running, touch-down and terminal cost, defects, equality residuals.
[[nodiscard]] Merit evaluate(const ProblemData& data, const Problem& problem,
                             const Trajectory& iterate) noexcept;

}  // namespace stilt::ocp
