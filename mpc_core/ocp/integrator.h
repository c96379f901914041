#pragma once

#include "mpc_core/model/batch.h"
#include "mpc_core/model/robot.h"
#include "mpc_core/ocp/parameters.h"

// clang-format off
/// Explicit Runge-Kutta steps of x' = [v; a_b(x, u); u_j] with the input held constant, for batches.
///
/// In second-order form the stages of a tableau with a_{i,i-1} = c_i (Heun's RK2, the classical RK4) are
///   V_i = v + c_i h A_{i-1},  Q_i = q + c_i h V_{i-1},  A_i = a(Q_i, V_i, u)
///   q+ = q + h v + h^2 sum_i b_{i+1} c_{i+1} A_i,  v+ = v + h sum_i b_i A_i.
/// Joint accelerations are inputs: only the three base rows are nonlinear, and of the integrated base only
/// the pitch feeds back. Real-time safe.
// clang-format on
namespace stilt::ocp {

using model::Batch;

/// Accelerations of the base averaged over a step: for the position (times h^2) and for the velocity (times
/// h).
struct BaseMotion {
  Batch for_position[3];
  Batch for_velocity[3];
};

/// With the derivatives of the step itself, i.e. of h^2 for_position and h for_velocity.
struct BaseStep : BaseMotion {
  static constexpr int kColumns = 2 * model::kAngles + model::kInputs;
  Batch d_position[3][kColumns];  ///< columns: theta (5), omega (5), u (8)
  Batch d_velocity[3][kColumns];
};

/// Scratch of integrate_base_derivatives; contents need not be initialised.
struct IntegratorWorkspace {
  model::FlowDerivatives<Batch> flow;
  Batch pitch_slope[2][BaseStep::kColumns];  ///< derivative of the pitch acceleration at stages 1 and 2
};

/// Accelerations of the base over one step of duration h (s). `first_acceleration`: base acceleration at the
/// start of the step, known from the node function.
void integrate_base(const model::RobotModel& robot, Integrator integrator, const Batch* x, const Batch* u,
                    const Batch& h, const Batch* first_acceleration, BaseMotion& motion) noexcept;

/// The same with derivatives. `first`: node function at the start of the step.
void integrate_base_derivatives(const model::RobotModel& robot, Integrator integrator, const Batch* x,
                                const Batch* u, const Batch& h, const model::NodeDerivatives<Batch>& first,
                                BaseStep& step, IntegratorWorkspace& work) noexcept;

/// Next state from the averaged accelerations.
void next_state(const Batch* x, const Batch* u, const Batch& h, const BaseMotion& motion,
                Batch* x_next) noexcept;

}  // namespace stilt::ocp
