#include "host_tools/gait_synthesis/hybrid_step.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace stilt::gait_synthesis {
namespace {

using model::JointVector;
using model::kFirstAngle;
using model::kFirstJoint;
using model::kInputs;
using model::kJoints;
using model::kPositions;
using model::StateVector;

constexpr int kSwingFootZ = 3;

model::InputVector input_of(const JointVector& acceleration, const Eigen::Vector2d& force_N) {
  model::InputVector u = model::InputVector::Zero();
  u.head<kJoints>() = acceleration;
  u.segment<2>(kJoints) = force_N;
  return u;
}

double swing_height_m(const model::RobotModel& robot, const StateVector& x) {
  model::KinematicsTerms<double> feet;
  robot.kinematics(x.data(), feet);
  return feet.foot_position[kSwingFootZ];
}

/// One step of the classical Runge-Kutta method under output feedback.
class FeedbackFlow {
 public:
  FeedbackFlow(const model::RobotModel& robot, const gait::HzdGait& gait, double shift_rad)
      : robot_(robot), gait_(gait), shift_rad_(shift_rad) {}

  [[nodiscard]] StateVector step(const StateVector& x, double time_s, double h) const {
    const StateVector k1 = slope(x, time_s);
    const StateVector k2 = slope(x + 0.5 * h * k1, time_s + 0.5 * h);
    const StateVector k3 = slope(x + 0.5 * h * k2, time_s + 0.5 * h);
    const StateVector k4 = slope(x + h * k3, time_s + h);
    return x + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }

 private:
  [[nodiscard]] StateVector slope(const StateVector& x, double time_s) const {
    const JointVector a = output_feedback(robot_, gait_, x, time_s, shift_rad_);
    const StanceMap map = stance_map(robot_, x);
    StateVector d;
    d.head<kPositions>() = x.tail<kPositions>();
    d.segment<3>(kPositions) = map.base_bias + map.base_gain * a;
    d.tail<kJoints>() = a;
    return d;
  }

  const model::RobotModel& robot_;
  const gait::HzdGait& gait_;
  double shift_rad_;
};

bool fallen(const model::RobotConstants& robot, const StateVector& x) {
  constexpr double kLowestShare = 0.3436;  // of the straight leg
  constexpr double kLargestPitch_rad = 1.2;
  const double lowest_m = kLowestShare * (robot.thigh_length_m + robot.shin_length_m);
  return !x.allFinite() || x[1] < lowest_m || std::abs(x[2]) > kLargestPitch_rad;
}

/// Part of the step h after which the swing foot reaches the ground, by regula falsi with bisection
/// (Illinois).
double time_to_ground(const model::RobotModel& robot, const FeedbackFlow& flow, const StateVector& x,
                      double time_s, double h) {
  double a = 0.0;
  double b = h;
  double za = swing_height_m(robot, x);
  double zb = swing_height_m(robot, flow.step(x, time_s, h));
  for (int iteration = 0; iteration < 60 && b - a > 1e-15; ++iteration) {
    const double middle = (za * b - zb * a) / (za - zb);
    const double z = swing_height_m(robot, flow.step(x, time_s, middle));
    if (std::abs(z) < 1e-15) return middle;
    if (z > 0.0) {
      a = middle;
      za = z;
      zb *= 0.5;
    } else {
      b = middle;
      zb = z;
      za *= 0.5;
    }
  }
  return 0.5 * (a + b);
}

}  // namespace

StanceMap stance_map(const model::RobotModel& robot, const StateVector& x) {
  const model::InputVector none = model::InputVector::Zero();
  model::NodeDerivatives<double> n;
  robot.node_derivatives(x.data(), none.data(), robot.constants.joint_parameters, n);
  using Rows2 = Eigen::Matrix<double, 2 * model::kFeet, kInputs, Eigen::RowMajor>;
  using Rows3 = Eigen::Matrix<double, 3, kInputs, Eigen::RowMajor>;
  const Eigen::Map<const Rows2> foot(&n.foot_acceleration_du[0][0]);
  const Eigen::Map<const Rows3> base(&n.base_acceleration_du[0][0]);
  const Eigen::Matrix2d compliance_inverse = foot.block<2, 2>(0, kJoints).inverse();
  StanceMap map;
  map.force_bias = -compliance_inverse * Eigen::Vector2d(n.foot_acceleration);
  map.force_gain = -compliance_inverse * foot.block<2, kJoints>(0, 0);
  const Eigen::Matrix<double, 3, 2> by_force = base.block<3, 2>(0, kJoints);
  map.base_bias = Eigen::Vector3d(n.base_acceleration) + by_force * map.force_bias;
  map.base_gain = base.block<3, kJoints>(0, 0) + by_force * map.force_gain;
  return map;
}

StanceMotion stance_motion(const model::RobotModel& robot, const StateVector& x,
                           const JointVector& acceleration) {
  const StanceMap map = stance_map(robot, x);
  StanceMotion motion;
  motion.joint_acceleration_rad_s2 = acceleration;
  motion.force_N = map.force_bias + map.force_gain * acceleration;
  const model::InputVector u = input_of(acceleration, motion.force_N);
  model::NodeTerms<double> terms;
  robot.node(x.data(), u.data(), robot.constants.joint_parameters, terms);
  motion.base_acceleration = Eigen::Vector3d(terms.base_acceleration);
  motion.torque_Nm = JointVector(terms.joint_torque);
  return motion;
}

double placement_shift_rad(const gait::HzdGait& gait, const StateVector& start) {
  const gait::GaitPoint nominal = gait::motion_at(gait, 0.0);
  double shift_rad = 0.0;
  for (int i = 0; i < model::kAngles; ++i) {
    const int at = kFirstAngle + i;
    shift_rad -= gait.feedback.placement[i] * (start[at] - nominal.position[at]);
    shift_rad -=
        gait.feedback.placement[model::kAngles + i] * (start[kPositions + at] - nominal.velocity[at]);
  }
  return shift_rad;
}

double phase_of(const gait::GaitOutputs& outputs, const StateVector& x, double time_s) {
  const double now = outputs.phase == gait::PhaseKind::time ? time_s : x[0];
  return std::clamp((now - outputs.phase_start) / (outputs.phase_end - outputs.phase_start), -0.1, 1.1);
}

JointVector output_feedback(const model::RobotModel& robot, const gait::HzdGait& gait, const StateVector& x,
                            double time_s, double shift_rad) {
  const gait::GaitOutputs& outputs = gait.outputs;
  const double s = phase_of(outputs, x, time_s);
  gait::OutputPoint y = gait::outputs_at(outputs, s);
  const gait::OutputPoint share = gait::placement_share(s);
  y.angle_rad += shift_rad * share.angle_rad;
  y.slope_rad += shift_rad * share.slope_rad;
  y.curvature_rad += shift_rad * share.curvature_rad;
  const bool by_time = outputs.phase == gait::PhaseKind::time;
  const double scale = 1.0 / (outputs.phase_end - outputs.phase_start);
  const double rate = by_time ? scale : scale * x[kPositions];
  const JointVector error = x.segment<kJoints>(kFirstJoint) - y.angle_rad;
  const JointVector error_rate = x.tail<kJoints>() - rate * y.slope_rad;
  JointVector wanted =
      rate * rate * y.curvature_rad - gait.feedback.kd_1_s * error_rate - gait.feedback.kp_1_s2 * error;
  if (by_time) return wanted;
  // With the phase by hip position the outputs accelerate with the hip, which depends on the joints. The
  // system a = wanted + g (bias + gain' a), g = scale dy/ds, is of rank one.
  const StanceMap map = stance_map(robot, x);
  const JointVector g = scale * y.slope_rad;
  const JointVector gain = map.base_gain.row(0).transpose();
  const JointVector right = wanted + g * map.base_bias[0];
  return right + g * (gain.dot(right) / (1.0 - gain.dot(g)));
}

StateVector touch_down(const model::RobotModel& robot, const StateVector& before,
                       Eigen::Vector2d* impulse_Ns) {
  model::ImpactTerms<double> impact;
  model::KinematicsTerms<double> feet;
  robot.impact({.right = true}, before.data(), robot.constants.joint_parameters, impact);
  robot.kinematics(before.data(), feet);
  if (impulse_Ns != nullptr) *impulse_Ns = Eigen::Vector2d(impact.impulse + 2 * model::kRight);
  constexpr int kSwapped[kPositions] = {0, 1, 2, 5, 6, 3, 4};
  StateVector after;
  for (int i = 0; i < kPositions; ++i) {
    after[i] = before[kSwapped[i]];
    after[kPositions + i] = impact.velocity_after[kSwapped[i]];
  }
  after[0] -= feet.foot_position[2];
  after[1] -= feet.foot_position[kSwingFootZ];
  return after;
}

std::optional<StepOutcome> integrate_step(const model::RobotModel& robot, const gait::HzdGait& gait,
                                          const StateVector& start, const StepOptions& options) {
  const double shift_rad = options.shift_rad.value_or(placement_shift_rad(gait, start));
  const FeedbackFlow flow(robot, gait, shift_rad);
  const double h = gait.step_time_s / options.integration_steps;
  StepOutcome outcome;
  StateVector x = start;
  for (int i = 0; i < 2 * options.integration_steps; ++i) {
    const double time_s = i * h;
    if (options.keep_samples) outcome.samples.push_back({time_s, x});
    const StateVector next = flow.step(x, time_s, h);
    if (fallen(robot.constants, next)) return std::nullopt;
    const bool second_half = phase_of(gait.outputs, next, time_s + h) > 0.5;
    if (second_half && swing_height_m(robot, next) <= 0.0 && swing_height_m(robot, x) > 0.0) {
      const double part = time_to_ground(robot, flow, x, time_s, h);
      outcome.duration_s = time_s + part;
      outcome.before = flow.step(x, time_s, part);
      if (options.keep_samples) outcome.samples.push_back({outcome.duration_s, outcome.before});
      outcome.after = touch_down(robot, outcome.before, &outcome.impulse_Ns);
      return outcome;
    }
    x = next;
  }
  return std::nullopt;
}

std::vector<StateVector> states_at(const model::RobotModel& robot, const gait::HzdGait& gait,
                                   const StateVector& start, const Eigen::VectorXd& times_s) {
  constexpr double kLongestStep_s = 1e-3;
  const FeedbackFlow flow(robot, gait, 0.0);
  std::vector<StateVector> states;
  StateVector x = start;
  double time_s = 0.0;
  for (const double until_s : times_s) {
    const int steps = static_cast<int>(std::ceil((until_s - time_s) / kLongestStep_s));
    const double h = steps > 0 ? (until_s - time_s) / steps : 0.0;
    for (int i = 0; i < steps; ++i) x = flow.step(x, time_s + i * h, h);
    time_s = until_s;
    states.push_back(x);
  }
  return states;
}

}  // namespace stilt::gait_synthesis
