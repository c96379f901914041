#include "mpc_core/control/torque_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stilt::control {
namespace {

using model::JointVector;
using model::kFirstJoint;
using model::kJoints;
using model::kPositions;

bool is_finite(const SensorReading& reading) noexcept {
  return std::isfinite(reading.time_s) && reading.joint_position_rad.allFinite() &&
         reading.joint_velocity_rad_s.allFinite() && std::isfinite(reading.base_pitch_rad) &&
         std::isfinite(reading.base_pitch_rate_rad_s);
}

double end_time_s(const Plan& plan) noexcept { return plan.node[plan.nodes - 1].time_s; }

}  // namespace

PlanPoint interpolate(const Plan& plan, double time_s) noexcept {
  const int last = plan.nodes - 1;
  int k = 0;
  while (k + 1 < last && plan.node[k + 1].time_s <= time_s) ++k;
  const PlanNode& from = plan.node[k];
  const PlanNode& to = plan.node[k + 1];
  const double duration_s = to.time_s - from.time_s;
  const double s = duration_s > 0.0 ? std::clamp((time_s - from.time_s) / duration_s, 0.0, 1.0) : 1.0;
  PlanPoint point;
  point.state = (1.0 - s) * from.state + s * to.state;
  // Positions on the cubic with the nodes' velocities: a straight line misses it by a h^2 / 8, 3 mrad at a
  // knee.
  const auto rise_from = from.state.tail<kPositions>() * duration_s;
  const auto rise_to = to.state.tail<kPositions>() * duration_s;
  const auto chord = to.state.head<kPositions>() - from.state.head<kPositions>();
  point.state.head<kPositions>() += s * (1.0 - s) * ((1.0 - s) * (rise_from - chord) - s * (rise_to - chord));
  const bool same_phase = from.mode == to.mode && k + 1 < last;
  point.input = from.input;
  if (same_phase) point.input += s * (to.input - from.input);
  point.gain = &from.gain;
  point.mode = from.mode;
  return point;
}

void TorqueLoop::configure(const model::RobotModel& robot, const ControllerParameters& parameters) noexcept {
  robot_ = &robot;
  law_ = parameters.torque_law;
  drive_ = drive_model(robot.constants, parameters.robot);
  estimator_.configure(robot, parameters.estimator);
}

TorqueCommand TorqueLoop::tick(const SensorReading& reading, const Plan& plan) noexcept {
  if (!is_finite(reading)) return damp_not_finite(reading);
  const model::ContactMode contact =
      plan.nodes >= 2 ? interpolate(plan, reading.time_s).mode : model::ContactMode{true, true};
  return tick_with_state(reading, estimator_.update(reading, contact), plan);
}

TorqueCommand TorqueLoop::tick_with_state(const SensorReading& reading, const model::StateVector& state,
                                          const Plan& plan) noexcept {
  if (!is_finite(reading) || !state.allFinite()) return damp_not_finite(reading);
  TorqueCommand command;
  command.estimated_state = state;
  command.torque_Nm = -law_.joint_kd_Nms_rad * reading.joint_velocity_rad_s;
  if (plan.nodes >= 2) {
    command.status = TorqueStatus::damping_stale_plan;
    if (reading.time_s <= end_time_s(plan)) {
      const JointVector torque_Nm = track(reading, state, interpolate(plan, reading.time_s));
      command.status = torque_Nm.allFinite() ? TorqueStatus::tracking : TorqueStatus::damping_not_finite;
      if (command.status == TorqueStatus::tracking) command.torque_Nm = torque_Nm;
    }
  }
  limit(reading, command);
  return command;
}

TorqueCommand TorqueLoop::damp_not_finite(const SensorReading& reading) const noexcept {
  TorqueCommand command;
  command.status = TorqueStatus::damping_not_finite;
  command.estimated_state.setConstant(std::numeric_limits<double>::quiet_NaN());
  for (int j = 0; j < kJoints; ++j) {
    const double velocity = reading.joint_velocity_rad_s[j];
    if (std::isfinite(velocity)) command.torque_Nm[j] = -law_.joint_kd_Nms_rad * velocity;
  }
  limit(reading, command);
  return command;
}

JointVector TorqueLoop::track(const SensorReading& reading, const model::StateVector& state,
                              const PlanPoint& point) const noexcept {
  model::InputVector input = point.input;
  if (law_.use_feedback_gains) input += point.gain->lazyProduct(state - point.state);
  model::NodeTerms<double> node;
  robot_->scalar.node(point.state.data(), input.data(), drive_.joint_parameters, node);
  JointVector torque_Nm;
  for (int j = 0; j < kJoints; ++j) {
    const double planned_velocity = point.state[kPositions + kFirstJoint + j];
    const double friction_Nm = law_.friction_compensation * drive_.coulomb_friction_Nm[j] *
                               std::tanh(planned_velocity / law_.friction_velocity_rad_s);
    torque_Nm[j] = node.joint_torque[j] + friction_Nm +
                   law_.joint_kp_Nm_rad * (point.state[kFirstJoint + j] - reading.joint_position_rad[j]) +
                   law_.joint_kd_Nms_rad * (planned_velocity - reading.joint_velocity_rad_s[j]);
  }
  return torque_Nm;
}

void TorqueLoop::limit(const SensorReading& reading, TorqueCommand& command) const noexcept {
  for (int j = 0; j < kJoints; ++j) {
    const double limited = drive_.limited_torque_Nm(j, command.torque_Nm[j], reading.joint_velocity_rad_s[j]);
    if (limited != command.torque_Nm[j]) command.saturated = true;
    command.torque_Nm[j] = limited;
  }
}

}  // namespace stilt::control
