#include "mpc_core/ocp/integrator.h"

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

const Tableau& tableau(Integrator integrator) noexcept {
  return integrator == Integrator::rk2 ? kHeun : kClassical;
}

/// Weight of A_i in the position update.
double position_weight(const Tableau& t, int i) noexcept {
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

}  // namespace

void integrate_base(const model::RobotModel& robot, Integrator integrator, const Batch* x, const Batch* u,
                    const Batch& h, const Batch* first_acceleration, BaseStep& step) noexcept {
  const Tableau& t = tableau(integrator);
  Batch pitch_acceleration[4];
  pitch_acceleration[0] = first_acceleration[2];
  for (int r = 0; r < 3; ++r) {
    step.for_position[r] = position_weight(t, 0) * first_acceleration[r];
    step.for_velocity[r] = t.b[0] * first_acceleration[r];
  }
  for (int i = 1; i < t.stages; ++i) {
    Batch xi[kStates];
    stage_state(t, i, x, u, h, pitch_acceleration, xi);
    model::FlowTerms<Batch> flow;
    robot.batch.flow(xi, u, flow);
    pitch_acceleration[i] = flow.base_acceleration[2];
    for (int r = 0; r < 3; ++r) {
      step.for_position[r] += position_weight(t, i) * flow.base_acceleration[r];
      step.for_velocity[r] += t.b[i] * flow.base_acceleration[r];
    }
  }
}

void integrate_base_derivatives(const model::RobotModel& robot, Integrator integrator, const Batch* x,
                                const Batch* u, const Batch& h, const model::NodeDerivatives<Batch>& first,
                                BaseStep& step) noexcept {
  constexpr int kColumns = BaseStep::kColumns;
  const Tableau& t = tableau(integrator);
  Batch pitch_acceleration[4];
  Batch pitch_slope[4][kColumns];  // derivative of each stage's pitch acceleration

  pitch_acceleration[0] = first.base_acceleration[2];
  for (int r = 0; r < 3; ++r) {
    step.for_position[r] = position_weight(t, 0) * first.base_acceleration[r];
    step.for_velocity[r] = t.b[0] * first.base_acceleration[r];
    for (int c = 0; c < kColumns; ++c) {
      const Batch& slope = c < kAngles       ? first.base_acceleration_dtheta[r][c]
                           : c < 2 * kAngles ? first.base_acceleration_domega[r][c - kAngles]
                                             : first.base_acceleration_du[r][c - 2 * kAngles];
      step.d_position[r][c] = position_weight(t, 0) * slope;
      step.d_velocity[r][c] = t.b[0] * slope;
      if (r == 2) pitch_slope[0][c] = slope;
    }
  }

  for (int i = 1; i < t.stages; ++i) {
    Batch xi[kStates];
    stage_state(t, i, x, u, h, pitch_acceleration, xi);
    model::FlowDerivatives<Batch> flow;
    robot.batch.flow_derivatives(xi, u, flow);
    pitch_acceleration[i] = flow.base_acceleration[2];
    const Batch ch = t.c[i] * h;
    const Batch cch = t.c[i] * t.c[i - 1] * h * h;
    for (int r = 0; r < 3; ++r) {
      step.for_position[r] += position_weight(t, i) * flow.base_acceleration[r];
      step.for_velocity[r] += t.b[i] * flow.base_acceleration[r];
      const Batch by_pitch = flow.base_acceleration_dtheta[r][0];
      const Batch by_rate = flow.base_acceleration_domega[r][0];
      for (int c = 0; c < kColumns; ++c) {
        // Through the stage's angles and rates as they follow from theta, omega and the joint accelerations
        // ...
        Batch slope;
        if (c < kAngles) {
          slope = flow.base_acceleration_dtheta[r][c];
        } else if (c < 2 * kAngles) {
          slope = ch * flow.base_acceleration_dtheta[r][c - kAngles] +
                  flow.base_acceleration_domega[r][c - kAngles];
        } else {
          const int input = c - 2 * kAngles;
          slope = flow.base_acceleration_du[r][input];
          if (input < kJoints) {
            slope += cch * flow.base_acceleration_dtheta[r][1 + input] +
                     ch * flow.base_acceleration_domega[r][1 + input];
          }
        }
        // ... and through the pitch, moved by the accelerations of the stages before.
        slope += ch * by_rate * pitch_slope[i - 1][c];
        if (i >= 2) slope += cch * by_pitch * pitch_slope[i - 2][c];
        step.d_position[r][c] += position_weight(t, i) * slope;
        step.d_velocity[r][c] += t.b[i] * slope;
        if (r == 2) pitch_slope[i][c] = slope;
      }
    }
  }
}

void next_state(const Batch* x, const Batch* u, const Batch& h, const BaseStep& step,
                Batch* x_next) noexcept {
  for (int r = 0; r < 3; ++r) {
    x_next[r] = x[r] + h * (x[kPositions + r] + h * step.for_position[r]);
    x_next[kPositions + r] = x[kPositions + r] + h * step.for_velocity[r];
  }
  for (int j = 0; j < kJoints; ++j) {
    const int q = kFirstJoint + j;
    x_next[q] = x[q] + h * (x[kPositions + q] + 0.5 * h * u[j]);
    x_next[kPositions + q] = x[kPositions + q] + h * u[j];
  }
}

}  // namespace stilt::ocp
