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

/// Up to kLanes transitions with the same feet touching down into the same contact mode. Unused lanes repeat
/// the last stage with weight 0.
struct TransitionBatch {
  model::ContactMode mode;  ///< after the touch-down
  std::array<bool, model::kFeet> touchdown{};
  int lanes = 0;
  int stage[kLanes] = {};
  Batch weight;
};

/// Kinds of touch-down: a foot lands while the other is in the air (2) or on the ground (2), both land (1).
inline constexpr int kTouchdowns = 5;
/// Each kind of touch-down can leave one batch partly filled.
inline constexpr int kMaxTransitionBatches = (kMaxSwitches + kLanes - 1) / kLanes + kTouchdowns;

/// Groups of stages that share batches: flows of a contact mode, then touch-downs of a kind. The batches of a
/// group are consecutive, in the horizon and in memory.
inline constexpr int kModes = 4;
inline constexpr int kGroups = kModes + kTouchdowns;

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
