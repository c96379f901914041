#include "mpc_core/control/torque_law.h"

#include <algorithm>
#include <cmath>

#include "mpc_core/model/debug_assert.h"

namespace stilt::control {
namespace {

using model::JointVector;
using model::kFirstJoint;
using model::kJoints;
using model::kPositions;

/// Share of the feedback gains that acts on a plan of this age (docs/decisions/0038-feedback-by-plan-age.md).
double feedback_share(const TorqueLawParameters& law, double age_s) noexcept {
  if (!law.use_feedback_gains) return 0.0;
  return std::clamp((age_s - law.feedback_from_age_s) / (law.feedback_full_age_s - law.feedback_from_age_s),
                    0.0, 1.0);
}

}  // namespace

void TorqueLaw::configure(const model::RobotModel& robot, const ControllerParameters& parameters) noexcept {
  robot_ = &robot;
  drive_ = drive_model(robot.constants, parameters.robot);
  friction_coefficient_ = parameters.inequality.friction_coefficient;
  tune(parameters.torque_law);
}

void TorqueLaw::tune(const TorqueLawParameters& law) noexcept {
  law_ = law;
  minimum_normal_force_N_ =
      ocp::MinimumNormalForce::of(law.minimum_normal_force_share, robot_->constants.total_mass_kg);
}

TorqueCommand TorqueLaw::follow(const SensorReading& reading, const model::StateVector& state,
                                const PlanPoint& point) const noexcept {
  STILT_ASSERT(robot_ != nullptr && point.gain != nullptr);
  model::InputVector input = point.input;
  const double share = feedback_share(law_, point.age_s);
  if (share > 0.0) input += share * point.gain->lazyProduct(state - point.state);
  bound_contact_forces(point.mode, input);
  TorqueCommand command;
  command.torque_Nm = track(reading, point.state, input);
  command.finite = command.torque_Nm.allFinite() && is_finite(reading) && state.allFinite();
  for (int j = 0; j < kJoints; ++j) {
    const double velocity = reading.joint_velocity_rad_s[j];
    const double damping_Nm = std::isfinite(velocity) ? -law_.joint_kd_Nms_rad * velocity : 0.0;
    const double wanted_Nm = command.finite ? command.torque_Nm[j] : damping_Nm;
    command.torque_Nm[j] = drive_.limited_torque_Nm(j, wanted_Nm, velocity);
  }
  return command;
}

// docs/decisions/0018-contact-forces-and-recovery.md
void TorqueLaw::bound_contact_forces(model::ContactMode mode, model::InputVector& input) const noexcept {
  for (int foot = 0; foot < model::kFeet; ++foot) {
    double& fx = input[kJoints + 2 * foot];
    double& fz = input[kJoints + 2 * foot + 1];
    if (!mode[foot]) {
      fx *= 0.0;  // a force that is not finite stays so
      fz *= 0.0;
      continue;
    }
    fz = std::max(fz, minimum_normal_force_N_(mode));
    fx = std::clamp(fx, -friction_coefficient_ * fz, friction_coefficient_ * fz);
  }
}

JointVector TorqueLaw::track(const SensorReading& reading, const model::StateVector& planned,
                             const model::InputVector& input) const noexcept {
  model::NodeTerms<double> node;
  robot_->node(planned.data(), input.data(), drive_.joint_parameters, node);
  JointVector torque_Nm;
  for (int j = 0; j < kJoints; ++j) {
    const double planned_velocity = planned[kPositions + kFirstJoint + j];
    const double friction_Nm = law_.friction_compensation * drive_.coulomb_friction_Nm[j] *
                               std::tanh(planned_velocity / law_.friction_velocity_rad_s);
    torque_Nm[j] = node.joint_torque[j] + friction_Nm +
                   law_.joint_kp_Nm_rad * (planned[kFirstJoint + j] - reading.joint_position_rad[j]) +
                   law_.joint_kd_Nms_rad * (planned_velocity - reading.joint_velocity_rad_s[j]);
  }
  return torque_Nm;
}

}  // namespace stilt::control
