#include "mpc_core/ocp/integrator.h"

#include <algorithm>

namespace stilt::ocp {
namespace {

using model::kAngles;
using model::kFirstAngle;
using model::kFirstJoint;
using model::kInputs;
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

/// State of stage i from the accelerations of the two stages before; base x and z do not matter to the
/// dynamics.
void stage_state(const Tableau& t, int i, const Batch* x, const Batch* u, const Batch& h,
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
  if (i >= 2) xi[pitch] += cch * pitch_acceleration[i - 2];
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
  for (int i = 1; i < t.stages; ++i) {
    Batch xi[kStates];
    stage_state(t, i, x, u, h, pitch_acceleration, xi);
    model::FlowTerms<Batch> flow;
    robot.batch.flow(xi, u, flow);
    pitch_acceleration[i] = flow.base_acceleration[2];
    for (int r = 0; r < 3; ++r) {
      if (position_weight(t, i) != 0.0) {
        motion.for_position[r] += position_weight(t, i) * flow.base_acceleration[r];
      }
      motion.for_velocity[r] += t.b[i] * flow.base_acceleration[r];
    }
  }
}

/// Row r of the base acceleration's derivatives by theta, omega and u, at the start of the step.
void copy_slopes(const model::NodeDerivatives<Batch>& from, int r, Batch* to) noexcept {
  std::copy(from.base_acceleration_dtheta[r], from.base_acceleration_dtheta[r] + kAngles, to);
  std::copy(from.base_acceleration_domega[r], from.base_acceleration_domega[r] + kAngles, to + kAngles);
  std::copy(from.base_acceleration_du[r], from.base_acceleration_du[r] + kInputs, to + 2 * kAngles);
}

template <const Tableau& t>
void average_derivatives(const model::RobotModel& robot, const Batch* x, const Batch* u, const Batch& h,
                         const model::NodeDerivatives<Batch>& first, BaseStep& step,
                         IntegratorWorkspace& work) noexcept {
  constexpr int kColumns = BaseStep::kColumns;
  const Batch h2 = h * h;
  Batch pitch_acceleration[4];
  pitch_acceleration[0] = first.base_acceleration[2];
  for (int r = 0; r < 3; ++r) {
    step.for_position[r] = position_weight(t, 0) * first.base_acceleration[r];
    step.for_velocity[r] = t.b[0] * first.base_acceleration[r];
    Batch slope[kColumns];
    copy_slopes(first, r, slope);
    if (r == 2) std::copy(slope, slope + kColumns, work.pitch_slope[0]);
    const Batch for_position = position_weight(t, 0) * h2;
    const Batch for_velocity = t.b[0] * h;
    for (int c = 0; c < kColumns; ++c) {
      step.d_position[r][c] = for_position * slope[c];
      step.d_velocity[r][c] = for_velocity * slope[c];
    }
  }

  for (int i = 1; i < t.stages; ++i) {
    Batch xi[kStates];
    stage_state(t, i, x, u, h, pitch_acceleration, xi);
    const model::FlowDerivatives<Batch>& flow = work.flow;
    robot.batch.flow_derivatives(xi, u, work.flow);
    pitch_acceleration[i] = flow.base_acceleration[2];
    const Batch ch = t.c[i] * h;
    const Batch cch = t.c[i] * t.c[i - 1] * h2;
    const Batch for_position = position_weight(t, i) * h2;
    const Batch for_velocity = t.b[i] * h;
    for (int r = 0; r < 3; ++r) {
      if (position_weight(t, i) != 0.0) {
        step.for_position[r] += position_weight(t, i) * flow.base_acceleration[r];
      }
      step.for_velocity[r] += t.b[i] * flow.base_acceleration[r];
      // Through the stage's angles and rates as they follow from theta, omega and the joint accelerations ...
      Batch slope[kColumns];
      for (int c = 0; c < kAngles; ++c) {
        slope[c] = flow.base_acceleration_dtheta[r][c];
        slope[kAngles + c] = ch * flow.base_acceleration_dtheta[r][c] + flow.base_acceleration_domega[r][c];
      }
      for (int c = 0; c < kInputs; ++c) slope[2 * kAngles + c] = flow.base_acceleration_du[r][c];
      for (int j = 0; j < kJoints; ++j) {
        if (t.c[i] * t.c[i - 1] != 0.0) {
          slope[2 * kAngles + j] += cch * flow.base_acceleration_dtheta[r][1 + j];
        }
        slope[2 * kAngles + j] += ch * flow.base_acceleration_domega[r][1 + j];
      }
      // ... and through the pitch, moved by the accelerations of the stages before.
      const Batch by_rate = ch * flow.base_acceleration_domega[r][0];
      for (int c = 0; c < kColumns; ++c) slope[c] += by_rate * work.pitch_slope[i - 1][c];
      if (i >= 2) {
        const Batch by_pitch = cch * flow.base_acceleration_dtheta[r][0];
        for (int c = 0; c < kColumns; ++c) slope[c] += by_pitch * work.pitch_slope[i - 2][c];
      }
      for (int c = 0; c < kColumns; ++c) {
        if (position_weight(t, i) != 0.0) step.d_position[r][c] += for_position * slope[c];
        step.d_velocity[r][c] += for_velocity * slope[c];
      }
      if (r == 2 && i + 1 < t.stages) std::copy(slope, slope + kColumns, work.pitch_slope[i]);
    }
  }
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
