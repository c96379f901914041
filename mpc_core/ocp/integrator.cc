#include "mpc_core/ocp/integrator.h"

#include "mpc_core/lq/simd_columns.h"

namespace stilt::ocp {
namespace {

using model::kAngles;
using model::kFirstAngle;
using model::kFirstJoint;
using model::kJoints;
using model::kPositions;
using model::kStates;

struct Tableau {
  int stages;
  double c[4];
  double b[4];
};

constexpr Tableau kHeun{2, {0.0, 1.0, 0.0, 0.0}, {0.5, 0.5, 0.0, 0.0}};
constexpr Tableau kClassical{4, {0.0, 0.5, 0.5, 1.0}, {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0}};

/// Weight of A_i in the position update.
constexpr double position_weight(const Tableau& t, int i) noexcept {
  return i + 1 < t.stages ? t.b[i + 1] * t.c[i + 1] : 0.0;
}

/// State of stage i from the accelerations of the two stages before. The dynamics do not depend on x and z of
/// the base.
template <const Tableau& t, int i>
STILT_INLINE inline void stage_state(const Batch* x, const Batch* u, const Batch& h,
                                     const Batch pitch_acceleration[4], Batch* xi) noexcept {
  const Batch ch = t.c[i] * h;
  const Batch cch = t.c[i] * t.c[i - 1] * h * h;
  for (int j = 0; j < kFirstAngle; ++j) {
    xi[j] = x[j];
    xi[kPositions + j] = x[kPositions + j];
  }
  const int pitch = kFirstAngle;
  xi[kPositions + pitch] = x[kPositions + pitch] + ch * pitch_acceleration[i - 1];
  xi[pitch] = x[pitch] + ch * x[kPositions + pitch];
  if constexpr (i >= 2) xi[pitch] += cch * pitch_acceleration[i - 2];
  for (int j = 0; j < kJoints; ++j) {
    const int q = kFirstJoint + j;
    xi[kPositions + q] = x[kPositions + q] + ch * u[j];
    xi[q] = x[q] + ch * x[kPositions + q] + cch * u[j];
  }
}

template <const Tableau& t>
void average(const model::RobotModel& robot, const Batch* x, const Batch* u, const Batch& h,
             const Batch* first_acceleration, BaseMotion& motion) noexcept {
  Batch pitch_acceleration[4];
  pitch_acceleration[0] = first_acceleration[2];
  for (int r = 0; r < 3; ++r) {
    motion.for_position[r] = position_weight(t, 0) * first_acceleration[r];
    motion.for_velocity[r] = t.b[0] * first_acceleration[r];
  }
  lq::unroll<t.stages - 1>([&](auto stage) STILT_INLINE {
    constexpr int i = stage + 1;
    Batch xi[kStates];
    stage_state<t, i>(x, u, h, pitch_acceleration, xi);
    model::FlowTerms<Batch> flow;
    robot.flow(xi, u, flow);
    pitch_acceleration[i] = flow.base_acceleration[2];
    for (int r = 0; r < 3; ++r) {
      if constexpr (position_weight(t, i) != 0.0) {
        motion.for_position[r] += position_weight(t, i) * flow.base_acceleration[r];
      }
      motion.for_velocity[r] += t.b[i] * flow.base_acceleration[r];
    }
  });
}

/// Derivative by column c (theta, omega, u) of row r of the base acceleration.
template <int c, class Terms>
[[nodiscard]] STILT_INLINE inline const Batch& slope_of(const Terms& terms, int r) noexcept {
  if constexpr (c < kAngles) {
    return terms.base_acceleration_dtheta[r][c];
  } else if constexpr (c < 2 * kAngles) {
    return terms.base_acceleration_domega[r][c - kAngles];
  } else {
    return terms.base_acceleration_du[r][c - 2 * kAngles];
  }
}

/// Derivative by column c of row r of the base acceleration at stage i, by the state at the start of the
/// step. It acts through the stage's angles and rates, which follow from theta, omega and the joint
/// accelerations. It also acts through the pitch, moved by the accelerations of the stages before.
/// `pitch_slope(m)`: derivative of stage m's pitch acceleration.
template <const Tableau& t, int i, int c, class PitchSlope>
STILT_INLINE inline Batch stage_slope(const model::FlowDerivatives<Batch>& flow, int r, const Batch& ch,
                                      const Batch& cch, const PitchSlope& pitch_slope) noexcept {
  const Batch* theta = flow.base_acceleration_dtheta[r];
  const Batch* omega = flow.base_acceleration_domega[r];
  Batch slope = slope_of<c>(flow, r);
  if constexpr (c >= kAngles && c < 2 * kAngles) {
    slope += ch * theta[c - kAngles];
  } else if constexpr (c >= 2 * kAngles && c < 2 * kAngles + kJoints) {
    constexpr int kAngle = 1 + c - 2 * kAngles;
    slope += ch * omega[kAngle];
    if constexpr (t.c[i] * t.c[i - 1] != 0.0) slope += cch * theta[kAngle];
  }
  slope += (ch * omega[0]) * pitch_slope(std::integral_constant<int, i - 1>{});
  if constexpr (i >= 2) slope += (cch * theta[0]) * pitch_slope(std::integral_constant<int, i - 2>{});
  return slope;
}

template <const Tableau& t>
void average_derivatives(const model::RobotModel& robot, const Batch* x, const Batch* u, const Batch& h,
                         const model::NodeDerivatives<Batch>& first, BaseStep& step,
                         IntegratorWorkspace& work) noexcept {
  constexpr int kPitch = 2;  // row of the base acceleration
  const Batch h2 = h * h;
  Batch pitch_acceleration[4];
  pitch_acceleration[0] = first.base_acceleration[kPitch];
  for (int r = 0; r < 3; ++r) {
    step.for_position[r] = position_weight(t, 0) * first.base_acceleration[r];
    step.for_velocity[r] = t.b[0] * first.base_acceleration[r];
  }

  lq::unroll<t.stages - 1>([&](auto stage) STILT_INLINE {
    constexpr int i = stage + 1;
    constexpr bool kMovesPosition = position_weight(t, i) != 0.0;
    Batch xi[kStates];
    stage_state<t, i>(x, u, h, pitch_acceleration, xi);
    const model::FlowDerivatives<Batch>& flow = work.flow;
    robot.flow_derivatives(xi, u, work.flow);
    pitch_acceleration[i] = flow.base_acceleration[kPitch];
    const Batch ch = t.c[i] * h;
    const Batch cch = t.c[i] * t.c[i - 1] * h2;
    const Batch for_position = position_weight(t, i) * h2;
    const Batch for_velocity = t.b[i] * h;
    const Batch first_position = position_weight(t, 0) * h2;
    const Batch first_velocity = t.b[0] * h;
    for (int r = 0; r < 3; ++r) {
      if constexpr (kMovesPosition) {
        step.for_position[r] += position_weight(t, i) * flow.base_acceleration[r];
      }
      step.for_velocity[r] += t.b[i] * flow.base_acceleration[r];
      lq::unroll<BaseStep::kColumns>([&](auto column) STILT_INLINE {
        constexpr int c = column;
        const Batch slope = stage_slope<t, i, c>(flow, r, ch, cch, [&](auto m) STILT_INLINE -> const Batch& {
          if constexpr (m == 0) {
            return slope_of<c>(first, kPitch);
          } else {
            return work.pitch_slope[m - 1][c];
          }
        });
        if constexpr (i == 1) {
          const Batch& start = slope_of<c>(first, r);
          step.d_position[r][c] = first_position * start;
          step.d_velocity[r][c] = first_velocity * start + for_velocity * slope;
        } else {
          step.d_velocity[r][c] += for_velocity * slope;
        }
        if constexpr (kMovesPosition) step.d_position[r][c] += for_position * slope;
        if constexpr (i + 1 < t.stages) {
          if (r == kPitch) work.pitch_slope[i - 1][c] = slope;
        }
      });
    }
  });
}

}  // namespace

void integrate_base(const model::RobotModel& robot, Integrator integrator, const Batch* x, const Batch* u,
                    const Batch& h, const Batch* first_acceleration, BaseMotion& motion) noexcept {
  if (integrator == Integrator::rk2) return average<kHeun>(robot, x, u, h, first_acceleration, motion);
  average<kClassical>(robot, x, u, h, first_acceleration, motion);
}

void integrate_base_derivatives(const model::RobotModel& robot, Integrator integrator, const Batch* x,
                                const Batch* u, const Batch& h, const model::NodeDerivatives<Batch>& first,
                                BaseStep& step, IntegratorWorkspace& work) noexcept {
  if (integrator == Integrator::rk2) {
    return average_derivatives<kHeun>(robot, x, u, h, first, step, work);
  }
  average_derivatives<kClassical>(robot, x, u, h, first, step, work);
}

void next_state(const Batch* x, const Batch* u, const Batch& h, const BaseMotion& motion,
                Batch* x_next) noexcept {
  for (int r = 0; r < 3; ++r) {
    x_next[r] = x[r] + h * (x[kPositions + r] + h * motion.for_position[r]);
    x_next[kPositions + r] = x[kPositions + r] + h * motion.for_velocity[r];
  }
  for (int j = 0; j < kJoints; ++j) {
    const int q = kFirstJoint + j;
    x_next[q] = x[q] + h * (x[kPositions + q] + 0.5 * h * u[j]);
    x_next[kPositions + q] = x[kPositions + q] + h * u[j];
  }
}

}  // namespace stilt::ocp
