#include "host_tools/gait_synthesis/gait_metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host_tools/gait_synthesis/hybrid_step.h"
#include "host_tools/gait_synthesis/joint_bounds.h"
#include "host_tools/gait_synthesis/motion_fit.h"
#include "host_tools/gait_synthesis/return_map.h"
#include "host_tools/gait_synthesis/step_program.h"

namespace stilt::gait_synthesis {
namespace {

using gait_files::GaitMetrics;
using model::kFirstJoint;
using model::kJoints;
using model::kPositions;
using model::StateVector;

constexpr int kSamples = 500;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

StateVector state_of(const gait::GaitPoint& point) {
  StateVector x;
  x << point.position, point.velocity;
  return x;
}

/// The equations of motion under the inputs of the file: joint accelerations and stance force.
class FileFlow {
 public:
  FileFlow(const model::RobotModel& robot, const gait::HzdGait& gait) : robot_(robot), gait_(gait) {}

  [[nodiscard]] StateVector slope(const StateVector& x, double s) const {
    const gait::GaitPoint point = gait::motion_at(gait_, s);
    model::InputVector u = model::InputVector::Zero();
    u.head<kJoints>() = point.acceleration.tail<kJoints>();
    u.segment<2>(kJoints) = point.force_N;
    model::FlowTerms<double> flow;
    robot_.flow(x.data(), u.data(), flow);
    StateVector d;
    d << x.tail<kPositions>(), Eigen::Vector3d(flow.base_acceleration), u.head<kJoints>();
    return d;
  }

  /// Integrates over [s, s + ds] with `steps` Runge-Kutta steps of order 4.
  [[nodiscard]] StateVector integrate(StateVector x, double s, double ds, int steps) const {
    const double part = ds / steps;
    const double h = part * gait_.step_time_s;
    for (int i = 0; i < steps; ++i, s += part) {
      const StateVector k1 = slope(x, s);
      const StateVector k2 = slope(x + 0.5 * h * k1, s + 0.5 * part);
      const StateVector k3 = slope(x + 0.5 * h * k2, s + 0.5 * part);
      const StateVector k4 = slope(x + h * k3, s + part);
      x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    return x;
  }

 private:
  const model::RobotModel& robot_;
  const gait::HzdGait& gait_;
};

double largest_defect(const model::RobotModel& robot, const gait::HzdGait& gait) {
  const StepTask task;  // for the grid of the optimisation
  const int intervals = 4 * task.elements * task.element_degree;
  constexpr int kRefinement = 4;
  const FileFlow flow(robot, gait);
  double largest = 0.0;
  for (int i = 0; i < intervals; ++i) {
    const double from = static_cast<double>(i) / intervals;
    const double to = static_cast<double>(i + 1) / intervals;
    const StateVector end =
        flow.integrate(state_of(gait::motion_at(gait, from)), from, to - from, kRefinement);
    largest = std::max(largest, (end - state_of(gait::motion_at(gait, to))).cwiseAbs().maxCoeff());
  }
  return largest;
}

/// Computes the extremes of the motion's curves.
void sample_motion(const model::RobotModel& robot, const gait::HzdGait& gait, GaitMetrics& metrics) {
  const JointBounds ranges = joint_bounds(robot.constants, {});
  metrics.joint_position_margin_rad = metrics.knee_min_rad = kInfinity;
  metrics.normal_force_min_N = metrics.clearance_m = metrics.swing_height_min_m = kInfinity;
  double torque_squared = 0.0;
  for (int i = 0; i <= kSamples; ++i) {
    const double s = static_cast<double>(i) / kSamples;
    const gait::GaitPoint point = gait::motion_at(gait, s);
    const StateVector x = state_of(point);
    const StanceMotion motion = stance_motion(robot, x, point.acceleration.tail<kJoints>());
    const gait::OutputPoint output =
        gait::outputs_at(gait.outputs, phase_of(gait.outputs, x, s * gait.step_time_s));
    for (int j = 0; j < kJoints; ++j) {
      const double angle = point.position[kFirstJoint + j];
      const auto raise = [](double& largest, double value) { largest = std::max(largest, std::abs(value)); };
      raise(metrics.peak_torque_Nm[j], motion.torque_Nm[j]);
      raise(metrics.peak_joint_speed_rad_s[j], point.velocity[kFirstJoint + j]);
      raise(metrics.output_error_max_rad, angle - output.angle_rad[j]);
      raise(metrics.torque_error_max_Nm, motion.torque_Nm[j] - point.torque_Nm[j]);
      const double margin = std::min(angle - ranges.position_min_rad[j], ranges.position_max_rad[j] - angle);
      metrics.joint_position_margin_rad = std::min(metrics.joint_position_margin_rad, margin);
      if (j % 2 == 1) metrics.knee_min_rad = std::min(metrics.knee_min_rad, angle);
    }
    torque_squared += motion.torque_Nm.squaredNorm() * (i == 0 || i == kSamples ? 0.5 : 1.0);
    metrics.pitch_max_rad = std::max(metrics.pitch_max_rad, std::abs(point.position[model::kFirstAngle]));
    metrics.normal_force_min_N = std::min(metrics.normal_force_min_N, motion.force_N[1]);
    const double ratio =
        motion.force_N[1] > 0.0 ? std::abs(motion.force_N[0]) / motion.force_N[1] : kInfinity;
    metrics.friction_ratio_max = std::max(metrics.friction_ratio_max, ratio);
    model::KinematicsTerms<double> feet;
    robot.kinematics(x.data(), feet);
    const double height_m = feet.foot_position[3];
    if (s >= 0.25 && s <= 0.75) metrics.clearance_m = std::min(metrics.clearance_m, height_m);
    if (s >= 0.05 && s <= 0.95) metrics.swing_height_min_m = std::min(metrics.swing_height_min_m, height_m);
  }
  constexpr double kInPlace_m = 1e-6;
  if (std::abs(gait.step_length_m) > kInPlace_m) {
    metrics.torque_squared_per_m =
        torque_squared / kSamples * gait.step_time_s / std::abs(gait.step_length_m);
  }
}

void sample_touch_down(const model::RobotModel& robot, const gait::HzdGait& gait, GaitMetrics& metrics) {
  const StateVector start = start_of_motion(gait);
  const StateVector end = state_of(gait::motion_at(gait, 1.0));
  Eigen::Vector2d impulse_Ns;
  const StateVector after = touch_down(robot, end, &impulse_Ns);
  const double shape = (reduce(after) - reduce(start)).cwiseAbs().maxCoeff();
  const double ends = std::abs(end[0] - start[0] - gait.step_length_m);
  metrics.periodicity_error = std::max(shape, ends);
  metrics.impulse_ratio = impulse_Ns[1] > 0.0 ? std::abs(impulse_Ns[0]) / impulse_Ns[1] : kInfinity;
  model::KinematicsTerms<double> feet;
  robot.kinematics(end.data(), feet);
  metrics.touchdown_slip_m_s = feet.foot_velocity[2];
  metrics.touchdown_speed_m_s = -feet.foot_velocity[3];
}

double replay_error(const model::RobotModel& robot, const gait::HzdGait& gait) {
  constexpr int kSteps = 5;
  StateVector x = expand(robot, reduce(start_of_motion(gait)));
  double largest = 0.0;
  for (int step = 0; step < kSteps; ++step) {
    StepOptions options;
    options.keep_samples = true;
    const auto outcome = integrate_step(robot, gait, x, options);
    if (!outcome) return kInfinity;
    for (const StepSample& sample : outcome->samples) {
      const gait::GaitPoint point = gait::motion_at(gait, sample.time_s / gait.step_time_s);
      const double error = (sample.x.head<kPositions>() - point.position).cwiseAbs().maxCoeff();
      largest = std::max(largest, error);
    }
    x = outcome->after;
  }
  return largest;
}

}  // namespace

GaitMetrics gait_metrics(const model::RobotModel& robot, const gait::HzdGait& gait) {
  GaitMetrics metrics;
  metrics.defect_max = largest_defect(robot, gait);
  sample_motion(robot, gait, metrics);
  sample_touch_down(robot, gait, metrics);
  metrics.replay_error_max = replay_error(robot, gait);
  const auto map = linearise_return_map(robot, gait, reduce(start_of_motion(gait)));
  for (std::size_t i = 0; i < gait::kReducedStates; ++i) {
    metrics.return_map_eigenvalues[i] = map ? map->eigenvalue_magnitudes[i] : kInfinity;
  }
  return metrics;
}

}  // namespace stilt::gait_synthesis
