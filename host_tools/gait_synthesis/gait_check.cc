#include "host_tools/gait_synthesis/gait_check.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "host_tools/gait_synthesis/gait_figures.h"
#include "host_tools/gait_synthesis/hybrid_step.h"
#include "host_tools/gait_synthesis/motion_fit.h"
#include "host_tools/gait_synthesis/return_map.h"

namespace stilt::gait_synthesis {
namespace {

using gait_files::GaitFigures;
using model::kJoints;

class Verdict {
 public:
  /// The name of a limit when it is not kept; a figure that is not a number keeps none.
  void need(bool kept, const std::string& name) {
    if (!kept) names_.push_back(name);
  }
  [[nodiscard]] std::vector<std::string> names() const { return names_; }

 private:
  std::vector<std::string> names_;
};

void check_limits(const GaitFigures& f, const gait::GaitLimits& limits, Verdict& verdict) {
  const auto largest = [](const double* values) { return *std::max_element(values, values + kJoints); };
  verdict.need(largest(f.peak_torque_Nm) <= limits.torque_Nm, "torque_Nm");
  verdict.need(f.joint_position_margin_rad >= limits.joint_position_margin_rad, "joint_position_margin_rad");
  verdict.need(f.knee_min_rad >= limits.knee_min_rad, "knee_min_rad");
  verdict.need(largest(f.peak_joint_speed_rad_s) <= limits.joint_speed_rad_s, "joint_speed_rad_s");
  verdict.need(f.pitch_max_rad <= limits.pitch_rad, "pitch_rad");
  verdict.need(f.friction_ratio_max <= limits.friction_ratio, "friction_ratio");
  verdict.need(f.normal_force_min_N >= limits.normal_force_min_N, "normal_force_min_N");
  verdict.need(f.impulse_ratio <= limits.impulse_ratio, "impulse_ratio");
  verdict.need(f.clearance_m >= limits.clearance_m, "clearance_m");
  verdict.need(f.swing_height_min_m >= 0.0, "swing_height");
  verdict.need(f.touchdown_speed_m_s >= limits.touchdown_speed_min_m_s, "touchdown_speed_min_m_s");
  verdict.need(f.touchdown_speed_m_s <= limits.touchdown_speed_max_m_s, "touchdown_speed_max_m_s");
  verdict.need(std::abs(f.touchdown_slip_m_s) <= limits.touchdown_slip_m_s, "touchdown_slip_m_s");
  verdict.need(f.return_map_eigenvalues[0] <= limits.return_map, "return_map");
}

/// Claims of accuracy are upper bounds; the others are values.
void check_claims(const GaitFigures& figures, const GaitFigures& claims, const CheckTolerances& tolerances,
                  Verdict& verdict) {
  GaitFigures computed = figures;
  GaitFigures claimed = claims;
  for (const auto& field : gait_files::figure_fields()) {
    const auto values = field.values(computed);
    const auto wanted = field.values(claimed);
    bool same = true;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double room = tolerances.claim_absolute + tolerances.claim_relative * std::abs(wanted[i]);
      same = same && std::abs(values[i] - wanted[i]) <= room;
    }
    verdict.need(same, std::string("claim ") + field.key);
  }
}

/// Pitch that puts both feet on the same height for given joints: by Newton's method from upright.
double pitch_on_both_feet(const model::RobotModel& robot, const model::JointVector& joints) {
  ReducedState r = ReducedState::Zero();
  r.segment<kJoints>(1) = joints;
  const auto height = [&](double pitch) {
    r[0] = pitch;
    model::KinematicsTerms<double> feet;
    robot.scalar.kinematics(expand(robot, r).data(), feet);
    return feet.foot_position[3];
  };
  constexpr double kMove = 1e-6;
  double pitch = 0.0;
  for (int i = 0; i < 30; ++i) {
    const double slope = (height(pitch + kMove) - height(pitch - kMove)) / (2.0 * kMove);
    if (std::abs(slope) < 1e-3) break;  // feet together: any pitch will do
    pitch -= height(pitch) / slope;
  }
  return std::clamp(pitch, -1.0, 1.0);
}

}  // namespace

GaitCheck check_gait(const model::RobotModel& robot, const gait_files::GaitRecord& record,
                     const CheckTolerances& tolerances) {
  GaitCheck check;
  check.figures = gait_figures(robot, record.gait);
  const GaitFigures& f = check.figures;
  const gait::HzdGait& gait = record.gait;
  Verdict verdict;
  verdict.need(f.defect_max <= tolerances.defect, "defect");
  verdict.need(f.periodicity_error <= tolerances.periodicity, "periodicity");
  verdict.need(f.output_error_max_rad <= tolerances.output_rad, "outputs");
  verdict.need(f.torque_error_max_Nm <= tolerances.torque_Nm, "torque_curve");
  verdict.need(f.replay_error_max <= tolerances.replay, "replay");
  verdict.need(std::abs(gait.speed_m_s - gait.step_length_m / gait.step_time_s) <= tolerances.speed_m_s,
               "speed");
  check_limits(f, record.limits, verdict);
  if (record.claims) check_claims(f, *record.claims, tolerances, verdict);
  check.violations = verdict.names();
  return check;
}

void complete_motion(const model::RobotModel& robot, gait::HzdGait& gait) {
  constexpr double kUsualStepTime_s = 0.4;
  const gait::GaitOutputs& outputs = gait.outputs;
  const double span = outputs.phase_end - outputs.phase_start;
  const bool by_time = outputs.phase == gait::PhaseKind::time;
  if (gait.step_time_s <= 0.0) {
    gait.step_time_s = !by_time && gait.speed_m_s != 0.0 ? span / gait.speed_m_s : kUsualStepTime_s;
  }
  const gait::OutputPoint first = gait::outputs_at(outputs, 0.0);
  ReducedState start = ReducedState::Zero();
  start.segment<kJoints>(1) = first.angle_rad;
  start.tail<kJoints>() = first.slope_rad / (by_time ? span : gait.step_time_s);
  start[0] = pitch_on_both_feet(robot, first.angle_rad);
  // Rate of the pitch that moves the hip at the mean speed; the speed of the hip is affine in it.
  const double speed_m_s = by_time ? gait.speed_m_s : span / gait.step_time_s;
  const double at_rest = expand(robot, start)[model::kPositions];
  start[model::kAngles] = 1.0;
  const double gain = expand(robot, start)[model::kPositions] - at_rest;
  start[model::kAngles] = (speed_m_s - at_rest) / gain;
  fit_motion(robot, expand(robot, start), gait);
}

}  // namespace stilt::gait_synthesis
