#include "mpc_core/ocp/problem.h"

#include <algorithm>
#include <cmath>

#include "mpc_core/model/debug_assert.h"

namespace stilt::ocp {
namespace {

using model::kFeet;
using model::kFirstJoint;
using model::kInputs;
using model::kJoints;
using model::kPositions;
using model::kStates;

[[maybe_unused]] bool is_finite(double value) noexcept { return std::isfinite(value); }

void set_lane(StageBatch& batch, int lane, int stage, double duration_s, double weight,
              const gait::ReferencePoint& point) noexcept {
  batch.stage[lane] = stage;
  batch.weight[lane] = weight;
  batch.duration[lane] = duration_s;
  for (int i = 0; i < kStates; ++i) batch.x_ref[i][lane] = point.state[i];
  for (int i = 0; i < kInputs; ++i) batch.u_ref[i][lane] = point.input[i];
  for (int i = 0; i < 2 * kFeet; ++i) {
    batch.foot_position_ref[i][lane] = point.foot_position_W_m[i];
    batch.foot_velocity_ref[i][lane] = point.foot_velocity_W_m_s[i];
    batch.foot_acceleration_ref[i][lane] = point.foot_acceleration_W_m_s2[i];
  }
}

struct TouchdownKind {
  model::ContactMode mode;  ///< afterwards
  std::array<bool, kFeet> touchdown;
};
constexpr std::array<TouchdownKind, kTouchdowns> kTouchdownKinds{{
    {.mode = {.left = true, .right = false}, .touchdown = {true, false}},
    {.mode = {.left = false, .right = true}, .touchdown = {false, true}},
    {.mode = {.left = true, .right = true}, .touchdown = {true, false}},
    {.mode = {.left = true, .right = true}, .touchdown = {false, true}},
    {.mode = {.left = true, .right = true}, .touchdown = {true, true}},
}};

/// Touch-downs of a kind share batches.
void fill_transition_batches(Problem& problem) noexcept {
  const Horizon& horizon = problem.horizon;
  problem.transition_batches = 0;
  for (int kind = 0; kind < kTouchdowns; ++kind) {
    const auto& [mode, touchdown] = kTouchdownKinds[static_cast<std::size_t>(kind)];
    TransitionBatch* batch = nullptr;
    for (int k = 0; k < horizon.stages; ++k) {
      const Stage& stage = horizon.stage[k];
      if (stage.kind != StageKind::transition || stage.touchdown != touchdown || stage.mode != mode) continue;
      if (batch == nullptr || batch->lanes == kLanes) {
        batch = &problem.transition_batch[problem.transition_batches++];
        batch->mode = mode;
        batch->touchdown = touchdown;
        batch->lanes = 0;
      }
      problem.place[k] = {problem.transition_batches - 1, kModes + kind, batch->lanes};
      batch->weight[batch->lanes] = 1.0;
      batch->stage[batch->lanes++] = k;
    }
    if (batch == nullptr) continue;
    for (int lane = batch->lanes; lane < kLanes; ++lane) {
      batch->weight[lane] = 0.0;
      batch->stage[lane] = batch->stage[batch->lanes - 1];
    }
  }
}

}  // namespace

void set_weights(ProblemData& data) noexcept {
  data.minimum_normal_force_N =
      MinimumNormalForce::of(data.inequality.minimum_normal_force_share, data.robot->constants.total_mass_kg);
  const CostParameters& c = data.cost;
  const double base[] = {c.base_x, c.base_z, c.base_pitch};
  const double base_velocity[] = {c.base_vx, c.base_vz, c.base_pitch_rate};
  for (int i = 0; i < 3; ++i) {
    data.state_weight[i] = base[i];
    data.state_weight[kPositions + i] = base_velocity[i];
  }
  for (int j = 0; j < kJoints; ++j) {
    data.state_weight[kFirstJoint + j] = c.joint_position;
    data.state_weight[kPositions + kFirstJoint + j] = c.joint_velocity;
    data.input_weight[j] = c.joint_acceleration;
    data.input_weight[kJoints + j] = c.contact_force;
  }
  STILT_ASSERT(std::ranges::all_of(data.state_weight, is_finite));
  STILT_ASSERT(std::ranges::all_of(data.input_weight, is_finite));
}

void fill_batches(const gait::HeuristicReference& reference, Problem& problem) noexcept {
  const Horizon& horizon = problem.horizon;
  STILT_ASSERT(horizon.stages > 0 && horizon.stages <= kMaxStages);
  problem.batches = 0;
  // Stages of one mode share batches, wherever they are in the horizon.
  for (int mode = 0; mode < kModes; ++mode) {
    const model::ContactMode contact{(mode & 1) != 0, (mode & 2) != 0};
    StageBatch* batch = nullptr;
    gait::ReferencePoint point;
    for (int k = 0; k < horizon.stages; ++k) {
      const Stage& stage = horizon.stage[k];
      if (stage.kind != StageKind::flow || !(stage.mode == contact)) continue;
      if (batch == nullptr || batch->lanes == kLanes) {
        batch = &problem.batch[problem.batches++];
        batch->mode = contact;
        batch->lanes = 0;
      }
      problem.place[k] = {problem.batches - 1, mode, batch->lanes};
      point = reference.evaluate(stage.time_s, stage.phase);
      set_lane(*batch, batch->lanes++, k, stage.duration_s, 1.0, point);
    }
    if (batch == nullptr) continue;
    const int last = batch->stage[batch->lanes - 1];
    for (int lane = batch->lanes; lane < kLanes; ++lane) {
      set_lane(*batch, lane, last, horizon.stage[last].duration_s, 0.0, point);
    }
  }
  fill_transition_batches(problem);
  STILT_ASSERT(problem.batches <= kMaxBatches && problem.transition_batches <= kMaxTransitionBatches);
  const gait::ReferencePoint end = reference.evaluate(horizon.end_s, horizon.end_phase);
  for (int i = 0; i < kStates; ++i) problem.x_ref_terminal[i] = end.state[i];
}

}  // namespace stilt::ocp
