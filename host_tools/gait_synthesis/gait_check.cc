#include "host_tools/gait_synthesis/gait_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host_tools/gait_synthesis/gait_metrics.h"
#include "host_tools/gait_synthesis/hybrid_step.h"
#include "host_tools/gait_synthesis/joint_bounds.h"
#include "host_tools/gait_synthesis/motion_fit.h"
#include "host_tools/gait_synthesis/return_map.h"

namespace stilt::gait_synthesis {
namespace {

using gait_files::GaitMetrics;
using model::kJoints;

using enum Violation::Bound;

/// Collects violations; a NaN value violates every bound.
class Verdict {
 public:
  void at_most(const std::string& name, double value, double bound) {
    if (!(value <= bound)) violations_.push_back({name, value, Violation::Bound::at_most, bound});
  }
  void accurate(const std::string& name, double value, double tolerance) {
    if (!(value <= tolerance))
      violations_.push_back({name, value, Violation::Bound::at_most, tolerance, true});
  }
  /// Of several joints the one with the least room below its bound.
  void each_at_most(const std::string& name, const double* values, const double* bounds) {
    int worst = 0;
    for (int j = 1; j < kJoints; ++j) {
      if (bounds[j] - values[j] < bounds[worst] - values[worst]) worst = j;
    }
    at_most(name, values[worst], bounds[worst]);
  }
  void at_least(const std::string& name, double value, double bound) {
    if (!(value >= bound)) violations_.push_back({name, value, Violation::Bound::at_least, bound});
  }
  void as_claimed(const std::string& name, double value, double claim, double tolerance) {
    const bool near = std::isfinite(claim) && std::abs(value - claim) <= tolerance;
    if (!near && value != claim) violations_.push_back({name, value, claimed, claim});
  }
  [[nodiscard]] const std::vector<Violation>& violations() const { return violations_; }

 private:
  std::vector<Violation> violations_;
};

void check_limits(const model::RobotConstants& robot, const GaitMetrics& f,
                  const gait_files::GaitLimits& limits, Verdict& verdict) {
  const JointBounds bounds = joint_bounds(robot, limits);
  verdict.each_at_most("torque_Nm", f.peak_torque_Nm, bounds.torque_Nm);
  verdict.at_least("joint_position_margin_rad", f.joint_position_margin_rad,
                   limits.joint_position_margin_rad);
  verdict.at_least("knee_min_rad", f.knee_min_rad, limits.knee_min_rad);
  verdict.each_at_most("joint_speed_rad_s", f.peak_joint_speed_rad_s, bounds.speed_rad_s);
  verdict.at_most("pitch_rad", f.pitch_max_rad, limits.pitch_rad);
  verdict.at_most("friction_ratio", f.friction_ratio_max, limits.friction_ratio);
  verdict.at_least("normal_force_min_N", f.normal_force_min_N, limits.normal_force_min_N);
  verdict.at_most("impulse_ratio", f.impulse_ratio, limits.impulse_ratio);
  verdict.at_least("clearance_m", f.clearance_m, limits.clearance_m);
  verdict.at_least("swing_height", f.swing_height_min_m, 0.0);
  verdict.at_least("touchdown_speed_min_m_s", f.touchdown_speed_m_s, limits.touchdown_speed_min_m_s);
  verdict.at_most("touchdown_speed_max_m_s", f.touchdown_speed_m_s, limits.touchdown_speed_max_m_s);
  verdict.at_most("touchdown_slip_m_s", std::abs(f.touchdown_slip_m_s), limits.touchdown_slip_m_s);
  verdict.at_most("return_map", f.return_map_eigenvalues[0], limits.return_map);
}

/// Adds the first of several values that differs from its claim.
void check_claims(const GaitMetrics& metrics, const GaitMetrics& claims, const CheckTolerances& tolerances,
                  Verdict& verdict) {
  GaitMetrics computed = metrics;
  GaitMetrics claimed_metrics = claims;
  for (const auto& field : gait_files::metric_fields()) {
    const auto values = field.values(computed);
    const auto wanted = field.values(claimed_metrics);
    const std::size_t before = verdict.violations().size();
    for (std::size_t i = 0; i < values.size() && verdict.violations().size() == before; ++i) {
      verdict.as_claimed(std::string("claim ") + field.key, values[i], wanted[i],
                         tolerances.claim_absolute + tolerances.claim_relative * std::abs(wanted[i]));
    }
  }
}

/// Pitch that puts both feet at the same height for given joints, by Newton's method from upright.
double pitch_on_both_feet(const model::RobotModel& robot, const model::JointVector& joints) {
  ReducedState r = ReducedState::Zero();
  r.segment<kJoints>(1) = joints;
  const auto height = [&](double pitch) {
    r[0] = pitch;
    model::KinematicsTerms<double> feet;
    robot.kinematics(expand(robot, r).data(), feet);
    return feet.foot_position[3];
  };
  constexpr double kMove = 1e-6;
  double pitch = 0.0;
  for (int i = 0; i < 30; ++i) {
    const double slope = (height(pitch + kMove) - height(pitch - kMove)) / (2.0 * kMove);
    if (std::abs(slope) < 1e-3) break;  // feet together: every pitch is a solution
    pitch -= height(pitch) / slope;
  }
  return std::clamp(pitch, -1.0, 1.0);
}

}  // namespace

const char* name(Violation::Bound kind) {
  switch (kind) {
    case at_most:
      return "at most";
    case at_least:
      return "at least";
    case claimed:
      break;
  }
  return "claimed";
}

std::string Violation::text() const {
  char numbers[80];
  (void)std::snprintf(numbers, sizeof numbers, " %.4g, %s %.4g", value, gait_synthesis::name(kind), bound);
  return name + numbers;
}

std::string unequal_legs(const model::RobotConstants& robot) {
  constexpr double kEqual = 1e-9;
  constexpr int kLegJoints = kJoints / 2;
  constexpr const char* kNames[kLegJoints] = {"hip", "knee"};
  const auto differ = [&](int left) {
    const double* p = robot.joint_parameters;
    return std::abs(p[left] - p[left + kLegJoints]) > kEqual * std::abs(p[left]);
  };
  for (int j = 0; j < kLegJoints; ++j) {
    const char* what = differ(j) ? "armature" : differ(kJoints + j) ? "damping" : nullptr;
    if (what == nullptr) continue;
    return std::string(robot.name)
        .append(": ")
        .append(kNames[j])
        .append("_L and ")
        .append(kNames[j])
        .append("_R have different ")
        .append(what)
        .append("; gaits are for robots with equal legs");
  }
  return "";
}

GaitCheck check_gait(const model::RobotModel& robot, const gait_files::GaitRecord& record,
                     const CheckTolerances& tolerances) {
  GaitCheck check;
  check.metrics = gait_metrics(robot, record.gait);
  const GaitMetrics& f = check.metrics;
  const gait::HzdGait& gait = record.gait;
  Verdict verdict;
  verdict.accurate("defect", f.defect_max, tolerances.defect);
  verdict.accurate("periodicity", f.periodicity_error, tolerances.periodicity);
  verdict.accurate("outputs", f.output_error_max_rad, tolerances.output_rad);
  verdict.accurate("torque_curve", f.torque_error_max_Nm, tolerances.torque_Nm);
  verdict.accurate("replay", f.replay_error_max, tolerances.replay);
  verdict.accurate("speed", std::abs(gait.speed_m_s - gait.step_length_m / gait.step_time_s),
                   tolerances.speed_m_s);
  check_limits(robot.constants, f, record.limits, verdict);
  if (record.claims) check_claims(f, *record.claims, tolerances, verdict);
  check.violations = verdict.violations();
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
  // Rate of the pitch for which the hip moves at the mean speed; the speed of the hip is affine in it.
  const double speed_m_s = by_time ? gait.speed_m_s : span / gait.step_time_s;
  const double at_rest = expand(robot, start)[model::kPositions];
  start[model::kAngles] = 1.0;
  const double gain = expand(robot, start)[model::kPositions] - at_rest;
  start[model::kAngles] = (speed_m_s - at_rest) / gain;
  double(&placement)[gait::kReducedStates] = gait.feedback.placement;
  double given[gait::kReducedStates];
  std::ranges::copy(placement, given);
  std::ranges::fill(placement, 0.0);  // the shift is from a motion that is not known yet
  fit_motion(robot, expand(robot, start), gait);
  const bool none = std::ranges::all_of(given, [](double value) { return value == 0.0; });
  if (none && place_feet(robot, gait)) return;
  std::ranges::copy(given, placement);
}

}  // namespace stilt::gait_synthesis
