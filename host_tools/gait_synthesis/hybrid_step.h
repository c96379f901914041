#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mpc_core/gait/hzd_gait.h"
#include "mpc_core/model/robot.h"

/// Integration of the hybrid model of walking. That is single support on the left foot without slip, then the
/// rigid impact of the right foot and the exchange of the legs.
namespace stilt::gait_synthesis {

/// Joint accelerations, the force that keeps the stance foot at rest, and the resulting accelerations.
struct StanceMotion {
  model::JointVector joint_acceleration_rad_s2;
  Eigen::Vector2d force_N;
  Eigen::Vector3d base_acceleration;
  model::JointVector torque_Nm;
};

/// Acceleration of the base and force on the stance foot as affine functions of the joint accelerations a,
/// for a stance foot at rest. base = base_bias + base_gain a, force = force_bias + force_gain a.
struct StanceMap {
  Eigen::Vector3d base_bias;
  Eigen::Matrix<double, 3, model::kJoints> base_gain;
  Eigen::Vector2d force_bias;
  Eigen::Matrix<double, 2, model::kJoints> force_gain;
};

/// The affine map of a state.
[[nodiscard]] StanceMap stance_map(const model::RobotModel& robot, const model::StateVector& x);

/// The motion for given joint accelerations.
[[nodiscard]] StanceMotion stance_motion(const model::RobotModel& robot, const model::StateVector& x,
                                         const model::JointVector& joint_acceleration_rad_s2);

/// Shift of the swing hip's output for a step that starts in `start`, just after a touch-down, rad.
[[nodiscard]] double placement_shift_rad(const gait::HzdGait& gait, const model::StateVector& start);

/// Phase of a state at `time_s` since touch-down, clamped to [-0.1, 1.1].
[[nodiscard]] double phase_of(const gait::GaitOutputs& outputs, const model::StateVector& x, double time_s);

/// Joint accelerations of the gait's output feedback: e'' + kd e' + kp e = 0 for the output error e. `shift`
/// (rad) is the shift of the swing hip's output in this step.
[[nodiscard]] model::JointVector output_feedback(const model::RobotModel& robot, const gait::HzdGait& gait,
                                                 const model::StateVector& x, double time_s,
                                                 double shift_rad);

struct StepSample {
  double time_s;
  model::StateVector x;
};

/// Result of one integrated step.
struct StepOutcome {
  double duration_s = 0.0;
  model::StateVector before;        ///< just before touch-down
  model::StateVector after;         ///< just after, legs swapped, stance foot at the origin
  Eigen::Vector2d impulse_Ns;       ///< on the foot that touches down
  std::vector<StepSample> samples;  ///< at every step of the integration, when requested
};

struct StepOptions {
  int integration_steps = 300;  ///< over the gait's step time; Runge-Kutta of order 4
  bool keep_samples = false;
  /// Replaces the shift by the gait's placement gains.
  std::optional<double> shift_rad;
};

/// Rigid touch-down of the right foot, exchange of the legs, stance foot moved to the origin.
[[nodiscard]] model::StateVector touch_down(const model::RobotModel& robot, const model::StateVector& before,
                                            Eigen::Vector2d* impulse_Ns = nullptr);

/// Integrates under the gait's output feedback from just after a touch-down to just after the next one. The
/// swing foot touches down when it reaches the ground in the second half of the step. Nothing when it does
/// not within two step times, or when the robot has fallen.
[[nodiscard]] std::optional<StepOutcome> integrate_step(const model::RobotModel& robot,
                                                        const gait::HzdGait& gait,
                                                        const model::StateVector& start,
                                                        const StepOptions& options = {});

/// States at ascending times (s, from 0) of a step without touch-down, under the gait's output feedback
/// without shift.
[[nodiscard]] std::vector<model::StateVector> states_at(const model::RobotModel& robot,
                                                        const gait::HzdGait& gait,
                                                        const model::StateVector& start,
                                                        const Eigen::VectorXd& times_s);

}  // namespace stilt::gait_synthesis
