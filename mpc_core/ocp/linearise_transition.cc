#include <algorithm>
#include <utility>

#include "mpc_core/ocp/barrier.h"
#include "mpc_core/ocp/batch_access.h"
#include "mpc_core/ocp/linearise.h"

namespace stilt::ocp {
namespace {

using lq::LqFirstOrder;
using lq::LqSecondOrder;
using model::kAngles;
using model::kFirstAngle;
using model::kInputs;
using model::kPositions;
using model::kStates;

constexpr int kMaxRows = 3 * model::kFeet;  ///< of the cost: velocity of a foot, both sides of its cone

/// State after the touch-downs of a batch and the impulses of the feet, with derivatives by the state before.
/// These are rows of A for the velocities, rows [x, z] of dJ for each foot.
struct TouchDown {
  Batch after[kStates];
  Batch A[kPositions][kStates];
  Batch impulse[2 * model::kFeet];
  Batch dJ[2 * model::kFeet][kStates];

  TouchDown(const ProblemData& data, const BatchParameters& parameters, const TransitionBatch& batch,
            const Batch* x) noexcept {
    std::copy(x, x + kStates, after);
    for (int r = 0; r < kPositions; ++r) {
      for (int c = 0; c < kStates; ++c) A[r][c] = Batch(c == kPositions + r ? 1.0 : 0.0);
    }
    if (data.discretisation.transition == Transition::identity) return;
    model::ImpactDerivatives<Batch> impact;
    data.robot->impact_derivatives(batch.mode, x, parameters.value, impact);
    std::copy(impact.velocity_after, impact.velocity_after + kPositions, after + kPositions);
    std::copy(impact.impulse, impact.impulse + 2 * model::kFeet, impulse);
    for (int r = 0; r < kPositions; ++r)
      write_row(impact.velocity_after_dtheta[r], impact.velocity_after_dv[r], A[r]);
    for (int r = 0; r < 2 * model::kFeet; ++r)
      write_row(impact.impulse_dtheta[r], impact.impulse_dv[r], dJ[r]);
  }

 private:
  static void write_row(const Batch* dtheta, const Batch* dv, Batch* row) noexcept {
    std::fill(row, row + kPositions, Batch(0.0));
    std::copy(dtheta, dtheta + kAngles, row + kFirstAngle);
    std::copy(dv, dv + kPositions, row + kPositions);
  }
};

}  // namespace

/// Linearises x+ = x, with the velocity changed by the impact of the feet that touch down when impacts are
/// modelled. A foot that stood before stays at rest. Adds the cost on the horizontal velocity of the landing
/// feet before the impact. Adds the barriers of the friction cone on the impulses of all feet in contact,
/// |Jx| <= mu Jz.
void linearise(const ProblemData& data, const TransitionBatch& batch, const Trajectory& iterate,
               const BatchModel& to) noexcept {
  for (int lane = 0; lane < kLanes; ++lane) {
    LqFirstOrder& stage = *to.first[lane];
    stage.h = 0.0;
    stage.form = lq::StageForm::transition;
    stage.constraints = stage.free_inputs = 0;
    InputProjection& inputs = *to.inputs[lane];
    std::fill(inputs.u0, inputs.u0 + kInputs, 0.0);
    inputs.u0_slope = 0.0;
    inputs.first_force = -1;
  }
  const BatchParameters parameters(data);
  const BatchTransition it(iterate, batch);
  const TouchDown touchdown(data, parameters, batch, it.x);

  // Rows of the cost: 1/2 curvature (row dx)^2 + slope row dx.
  Batch row[kMaxRows][kStates];
  Batch slope[kMaxRows];
  Batch curvature[kMaxRows];
  int count = 0;
  model::KinematicsTerms<Batch> feet;
  data.robot->kinematics(it.x, feet);
  for (int foot = 0; foot < model::kFeet; ++foot) {
    if (!batch.touchdown[foot]) continue;
    // Cost 1/2 weight (horizontal velocity of the foot)^2. All links turn in one plane, and an angle turns
    // the links behind it. It turns their columns of the Jacobian, d J_x / d angle = J_z.
    std::fill(row[count], row[count] + kStates, Batch(0.0));
    row[count][kPositions] = Batch(1.0);
    const Batch* J_x = feet.foot_jacobian[2 * foot];
    const Batch* J_z = feet.foot_jacobian[2 * foot + 1];
    for (const int c : model::kChainAngles[foot]) {
      for (const int other : model::kChainAngles[foot]) {
        row[count][kFirstAngle + c] +=
            J_z[kFirstAngle + std::max(c, other)] * it.x[kPositions + kFirstAngle + other];
      }
      row[count][kPositions + kFirstAngle + c] = J_x[kFirstAngle + c];
    }
    curvature[count] = Batch(data.cost.touchdown_velocity);
    slope[count] = data.cost.touchdown_velocity * feet.foot_velocity[2 * foot];
    ++count;
  }
  for (int foot = 0; foot < model::kFeet && data.discretisation.transition == Transition::impact; ++foot) {
    if (!batch.mode[foot]) continue;
    // Barriers of mu Jz + Jx and mu Jz - Jx.
    const double mu = data.inequality.friction_coefficient;
    const Batch& Jx = touchdown.impulse[2 * foot];
    const Batch friction_Ns = mu * touchdown.impulse[2 * foot + 1];
    const BarrierPair pair(BarrierCurve(data.inequality.impulse), friction_Ns + Jx, friction_Ns - Jx);
    const auto& dJx = touchdown.dJ[2 * foot];
    const auto& dJz = touchdown.dJ[2 * foot + 1];
    for (const auto& [barrier, sign] : {std::pair{pair.a, 1.0}, std::pair{pair.b, -1.0}}) {
      for (int c = 0; c < kStates; ++c) row[count][c] = mu * dJz[c] + sign * dJx[c];
      slope[count] = barrier.first;
      curvature[count] = barrier.second;
      ++count;
    }
  }
  const auto gradient = [&](int c) {
    Batch sum = Batch(0.0);
    for (int i = 0; i < count; ++i) sum += slope[i] * row[i][c];
    return sum;
  };

  double* rows[kLanes];
  for (int i = 0; i < kPositions; ++i) {
    to.rows([&](LqFirstOrder& stage) { return stage.G[i]; }, rows);
    store_rows<kStates>(rows, [&](auto c) { return touchdown.A[i][c] - (c == kPositions + i ? 1.0 : 0.0); });
  }
  // Of the Hessian the columns below the diagonal; no term depends on the position of the base.
  lq::unroll<kStates>([&](auto column) STILT_INLINE {
    constexpr int c = column;
    Batch factor[kMaxRows];
    for (int i = 0; i < count; ++i) factor[i] = curvature[i] * row[i][c];
    to.rows([](LqSecondOrder& stage) { return stage.Q[c]; }, rows);
    store_rows<kStates, c / kLanes>(rows, [&](auto r) STILT_INLINE {
      Batch sum = Batch(0.0);
      if constexpr (c >= kFirstAngle && r >= c) {
        for (int i = 0; i < count; ++i) sum += factor[i] * row[i][r];
      }
      return sum;
    });
  });
  to.rows([](LqFirstOrder& stage) { return stage.q; }, rows);
  store_rows<kStates>(rows, [&](auto c) { return gradient(c); });
  to.rows([](LqFirstOrder& stage) { return stage.b; }, rows);
  store_rows<kStates>(rows, [&](auto i) { return touchdown.after[i] - it.x_next[i]; });
}

}  // namespace stilt::ocp
