#include "tests/host_tools/web/report/synthetic_walk.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stilt::report {
namespace {

constexpr double kSpeed_m_s = 0.5;
constexpr double kStep_s = 0.4;
constexpr double kHipHeight_m = 0.8;
constexpr double kSwingHeight_m = 0.06;
constexpr double kThigh_m = 0.4064;
constexpr double kShin_m = 0.4667;
constexpr double kWeight_N = 21.5565 * model::kGravity_m_s2;

/// Number of the step in progress; the left foot stands in even ones.
long step_number(double time_s) { return std::lround(std::floor(time_s / kStep_s + 1e-9)); }

double hip_x(double time_s) { return kSpeed_m_s * time_s; }

double hip_z(double time_s) {
  return kHipHeight_m + 0.004 * std::cos(2.0 * std::numbers::pi * time_s / kStep_s);
}

double pitch(double time_s) { return 0.03 + 0.02 * std::sin(2.0 * std::numbers::pi * time_s / kStep_s); }

/// Where a foot stands during step `number`: below the hip in the middle of it.
double foothold_x(long number) { return hip_x((static_cast<double>(number) + 0.5) * kStep_s); }

bool stands(int foot, double time_s) { return (step_number(time_s) % 2 == 0) == (foot == model::kLeft); }

model::FeetVector feet(double time_s) {
  model::FeetVector position;
  const long number = step_number(time_s);
  for (int foot = 0; foot < model::kFeet; ++foot) {
    if (stands(foot, time_s)) {
      position.segment<2>(2 * foot) << foothold_x(number), 0.0;
    } else {
      const double s = time_s / kStep_s - static_cast<double>(number);
      const double blend = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
      const double from = foothold_x(number - 1);
      position.segment<2>(2 * foot) << from + blend * (foothold_x(number + 1) - from),
          16.0 * kSwingHeight_m * s * s * (1.0 - s) * (1.0 - s);
    }
  }
  return position;
}

model::PositionVector positions(double time_s) {
  model::PositionVector q;
  q.head<3>() << hip_x(time_s), hip_z(time_s), pitch(time_s);
  const model::FeetVector foot = feet(time_s);
  for (int side = 0; side < model::kFeet; ++side) {
    const double dx = foot[2 * side] - q[0];
    const double dz = foot[2 * side + 1] - q[1];
    const double cosine =
        (dx * dx + dz * dz - kThigh_m * kThigh_m - kShin_m * kShin_m) / (2.0 * kThigh_m * kShin_m);
    const double knee = std::acos(std::clamp(cosine, -1.0, 1.0));
    const double thigh =
        std::atan2(-dx, -dz) - std::atan2(kShin_m * std::sin(knee), kThigh_m + kShin_m * std::cos(knee));
    q.segment<2>(3 + 2 * side) << thigh - q[2], knee;
  }
  return q;
}

model::StateVector state(double time_s) {
  constexpr double kDifference_s = 1e-4;
  model::StateVector x;
  x << positions(time_s),
      (positions(time_s + kDifference_s) - positions(time_s - kDifference_s)) / (2.0 * kDifference_s);
  return x;
}

log::RunSample sample(double time_s) {
  log::RunSample s;
  const double wave = std::sin(2.0 * std::numbers::pi * time_s / kStep_s);
  s.time_s = time_s;
  s.true_state = state(time_s);
  s.planned_state = state(time_s + 0.004);
  s.estimated_state = s.true_state;
  s.estimated_state[0] += 0.002 * std::sin(0.7 * time_s);
  s.estimated_state[1] += 0.001 * wave;
  s.estimated_state[7] += 0.01 * wave;
  s.foot_position_m = feet(time_s);
  s.scheduled_mode = {stands(model::kLeft, time_s), stands(model::kRight, time_s)};
  s.contact_force_N.setZero();
  s.planned_contact_force_N.setZero();
  for (int foot = 0; foot < model::kFeet; ++foot) {
    const bool loaded = stands(foot, time_s);
    const double lever = s.foot_position_m[2 * foot] - hip_x(time_s);
    const double normal = kWeight_N * (1.0 + 0.15 * wave);
    if (loaded) s.contact_force_N.segment<2>(2 * foot) << -lever / kHipHeight_m * normal, normal;
    if (loaded) s.planned_contact_force_N.segment<2>(2 * foot) << 0.0, kWeight_N;
    s.torque_Nm.segment<2>(2 * foot) << (loaded ? 12.0 : -8.0) * wave,
        loaded ? -25.0 + 8.0 * wave : 6.0 * wave;
  }
  s.push_N = time_s >= 5.0 && time_s < 6.0 ? 40.0 : 0.0;
  s.commanded_speed_m_s = kSpeed_m_s;
  return s;
}

log::PlanSnapshot plan(double time_s) {
  log::PlanSnapshot p;
  p.time_s = time_s;
  for (int k = 0; k <= 134; ++k) {
    const double node_s = time_s + 0.015 * k;
    p.node_time_s.push_back(node_s);
    p.base_x_m.push_back(hip_x(node_s));
    p.base_z_m.push_back(hip_z(node_s));
    p.pitch_rad.push_back(pitch(node_s));
    p.foot_position_m.push_back(feet(node_s));
  }
  return p;
}

log::SolveSample solve(double time_s) {
  log::SolveSample s;
  const double wave = std::sin(11.0 * time_s) * std::sin(2.3 * time_s);
  s.time_s = time_s;
  s.solve_us = 1400.0 + 500.0 * wave;
  s.report.status = sqp::SolveStatus::converged;
  s.report.iterations = 2 + static_cast<int>(std::lround(1.4 * std::max(0.0, wave)));
  s.report.dynamics_defect_max = 1e-5 * (1.1 + wave);
  s.report.equality_violation_max = 1e-4 * (1.2 - wave);
  return s;
}

}  // namespace

log::RunRecord synthetic_walk(double duration_s) {
  log::RunRecord record;
  record.command_line = "stilt sim --robot amber3m --gait walk --speed 0.5 --push 40@5+1 --report walk.html";
  record.robot = {"amber3m", 0.4999, kThigh_m, kShin_m};
  std::ranges::fill(record.torque_limit_Nm, 80.0);
  const long samples = std::lround(duration_s * 200.0);
  for (long i = 0; i <= samples; ++i) record.samples.push_back(sample(0.005 * static_cast<double>(i)));
  for (long i = 0; i < samples / 2; ++i) {
    record.plans.push_back(plan(0.01 * static_cast<double>(i)));
    record.solves.push_back(solve(0.01 * static_cast<double>(i)));
  }
  log::RunSummary& summary = record.summary;
  for (long number = 1; static_cast<double>(number) * kStep_s < duration_s; ++number) {
    summary.steps.push_back({static_cast<double>(number) * kStep_s, number % 2 == 0 ? "L" : "R",
                             kSpeed_m_s * kStep_s + 0.01 * std::sin(static_cast<double>(number))});
  }
  summary.survived = true;
  summary.duration_s = duration_s;
  summary.distance_m = hip_x(duration_s);
  summary.mean_speed_m_s = kSpeed_m_s;
  summary.step_length_min_m = 0.19;
  summary.step_length_max_m = 0.21;
  summary.peak_torque_Nm << 12.0, 33.0, 12.0, 33.0;
  summary.peak_joint_speed_rad_s << 1.5, 2.4, 1.5, 2.4;
  summary.slip_distance_m = 0.003;
  summary.solve_time_us = {1400.0, 1880.0, 1900.0};
  summary.sqp_iterations_mean = 2.2;
  summary.sqp_iterations_max = 3;
  summary.dynamics_defect_max = 2.1e-5;
  summary.equality_violation_max = 2.2e-4;
  summary.controller_bytes = 512 * 1024;
  return record;
}

}  // namespace stilt::report
