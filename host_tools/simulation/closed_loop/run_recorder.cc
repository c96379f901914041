#include "host_tools/simulation/closed_loop/run_recorder.h"

#include <algorithm>
#include <cmath>

namespace stilt::simulation {
namespace {

constexpr double kSnapshotRate_hz = 20.0;
constexpr double kPlanInUse_s = 0.3;   // the part of a plan whose constraints are reported
constexpr double kTimeSlack_s = 1e-9;  // equal to that of pushes, so that both begin at the same tick

int every(double rate_hz, double wished_hz) {
  return std::max(1, static_cast<int>(std::lround(rate_hz / wished_hz)));
}

}  // namespace

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double rank = std::ceil(share * static_cast<double>(values.size()));
  return values[static_cast<std::size_t>(std::clamp(rank, 1.0, static_cast<double>(values.size()))) - 1];
}

log::Percentiles percentiles(const std::vector<double>& values) {
  return {percentile(values, 0.5), percentile(values, 0.99), percentile(values, 1.0)};
}

RunRecorder::RunRecorder(const RunSettings& settings, const control_loop::PlanTiming& timing,
                         double planned_friction, log::RunRecord& record)
    : settings_(settings),
      record_(record),
      planned_friction_(planned_friction),
      tick_s_(1e-9 * static_cast<double>(timing.tick_ns)) {
  const double tick_rate_hz = 1.0 / tick_s_;
  ticks_per_sample_ = every(tick_rate_hz, settings.sample_rate_hz);
  plans_per_snapshot_ = every(tick_rate_hz / static_cast<double>(timing.period_ticks), kSnapshotRate_hz);
  start_x_m_ = settings.initial_state[0];
  speed_.add(0.0, start_x_m_);
  record_.summary.peak_torque_Nm.setZero();
  record_.summary.peak_joint_speed_rad_s.setZero();
}

void RunRecorder::observe_step(const Plant& plant) {
  log::RunSummary& summary = record_.summary;
  const model::JointVector speed = plant.state().tail<model::kJoints>().cwiseAbs();
  summary.peak_torque_Nm = summary.peak_torque_Nm.cwiseMax(plant.applied_torque_Nm().cwiseAbs());
  summary.peak_joint_speed_rad_s = summary.peak_joint_speed_rad_s.cwiseMax(speed);
  summary.fall_margin_min = std::min(summary.fall_margin_min, plant.fall_margin());
  if (plant.saturated() && measuring_) summary.saturated_s += plant.time_step_s();
}

void RunRecorder::observe_tick(double time_s, const Plant& plant, const control_loop::TickRecord& tick,
                               const control::Plan& active_plan) {
  record_.summary.fallback_s[static_cast<std::size_t>(tick.level)] += tick_s_;
  steps_.update(time_s, plant.contact_force_N(), plant.foot_position_m(), plant.state()[0]);
  if (!measuring_ && time_s >= settings_.measure_from_s - kTimeSlack_s) {
    measuring_ = true;
    slip_before_m_ = plant.slip_distance_m();
  }
  speed_.add(time_s, plant.state()[0]);
  if (settings_.keep_samples && ticks_ % ticks_per_sample_ == 0)
    take_sample(time_s, plant, tick, active_plan);
  ++ticks_;
  if (tick.plan_sequence >= 0 && tick.plan_sequence != plan_in_use_) observe_plan_in_use(active_plan);
}

void RunRecorder::observe_plan_in_use(const control::Plan& plan) {
  plan_in_use_ = plan.sequence;
  log::PlanInUse& seen = record_.summary.plan_in_use;
  seen.defect_max = std::max(seen.defect_max, plan.report.dynamics_defect_max);
  seen.equality_violation_max = std::max(seen.equality_violation_max, plan.report.equality_violation_max);
  for (int k = 0; k + 1 < plan.nodes; ++k) {
    const control::PlanNode& node = plan.node[static_cast<std::size_t>(k)];
    if (node.time_s > plan.start_time_s + kPlanInUse_s) break;
    if (plan.node[static_cast<std::size_t>(k + 1)].time_s == node.time_s) continue;  // a touch-down
    for (int foot = 0; foot < model::kFeet; ++foot) {
      if (!node.mode[foot]) continue;
      const double fx_N = node.input[model::kJoints + 2 * foot];
      const double fz_N = node.input[model::kJoints + 2 * foot + 1];
      const double cone_N = std::abs(fx_N) - planned_friction_ * std::max(fz_N, 0.0);
      seen.cone_violation_max_N = std::max(seen.cone_violation_max_N, cone_N);
      seen.normal_force_min_N = std::min(seen.normal_force_min_N, fz_N);
    }
  }
}

void RunRecorder::take_sample(double time_s, const Plant& plant, const control_loop::TickRecord& tick,
                              const control::Plan& active_plan) {
  const ActingPush push = push_at(settings_.pushes, time_s);
  const gait::GaitCommand command = command_at(settings_.commands, time_s);
  const model::StateVector truth = plant.state();
  log::RunSample sample;
  sample.time_s = time_s;
  sample.true_state = truth;
  sample.estimated_state = Eigen::Map<const model::StateVector>(tick.estimated_state.data());
  sample.torque_Nm = plant.applied_torque_Nm();
  sample.contact_force_N = plant.contact_force_N();
  sample.planned_state.setZero();
  sample.planned_contact_force_N.setZero();
  if (tick.plan_sequence >= 0) {
    const control::PlanPoint planned = control::interpolate(active_plan, time_s);
    sample.planned_state = planned.state;
    sample.planned_contact_force_N = planned.input.tail<2 * model::kFeet>();
    sample.scheduled_mode = planned.mode;
  }
  sample.foot_position_m = plant.foot_position_m();
  sample.push_N = push.force_N;
  sample.push_above_hip_m = push_above_hip_m(push.point);
  sample.commanded_speed_m_s = command.kind == gait::GaitKind::walk ? command.speed_m_s : 0.0;
  record_.samples.push_back(sample);
}

void RunRecorder::observe_plan(const log::SolveSample& solve, const control::Plan& plan) {
  record_.solves.push_back(solve);
  if (settings_.keep_samples && solve.report.usable() && plans_ % plans_per_snapshot_ == 0)
    take_snapshot(plan);
  ++plans_;
}

void RunRecorder::take_snapshot(const control::Plan& plan) {
  log::PlanSnapshot snapshot;
  snapshot.time_s = plan.start_time_s;
  for (int k = 0; k < plan.nodes; ++k) {
    const control::PlanNode& node = plan.node[static_cast<std::size_t>(k)];
    snapshot.node_time_s.push_back(node.time_s);
    snapshot.base_x_m.push_back(node.state[0]);
    snapshot.base_z_m.push_back(node.state[1]);
    snapshot.pitch_rad.push_back(node.state[2]);
    snapshot.foot_position_m.push_back(foot_positions(settings_.leg, node.state));
  }
  record_.plans.push_back(std::move(snapshot));
}

void RunRecorder::summarise_solves() {
  log::RunSummary& summary = record_.summary;
  std::vector<double> times_us;
  double iterations = 0.0;
  for (const log::SolveSample& solve : record_.solves) {
    times_us.push_back(solve.solve_us);
    iterations += solve.report.iterations;
    summary.sqp_iterations_max = std::max(summary.sqp_iterations_max, solve.report.iterations);
    summary.dynamics_defect_max = std::max(summary.dynamics_defect_max, solve.report.dynamics_defect_max);
    summary.equality_violation_max =
        std::max(summary.equality_violation_max, solve.report.equality_violation_max);
  }
  summary.solve_time_us = percentiles(times_us);
  if (!times_us.empty()) summary.sqp_iterations_mean = iterations / static_cast<double>(times_us.size());
}

void RunRecorder::finish(double time_s, const Plant& plant, long long heap_allocations) {
  log::RunSummary& summary = record_.summary;
  summary.survived = plant.fall() == Fall::none;
  summary.fall_time_s = summary.survived ? -1.0 : time_s;
  summary.duration_s = time_s;
  summary.distance_m = plant.state()[0] - start_x_m_;
  speed_.add(time_s, plant.state()[0]);
  summary.mean_speed_m_s = speed_.value_m_s();
  summary.steps = steps_.steps();
  for (const log::Step& step : summary.steps) {
    const bool first = &step == &summary.steps.front();
    summary.step_length_min_m = first ? step.length_m : std::min(summary.step_length_min_m, step.length_m);
    summary.step_length_max_m = first ? step.length_m : std::max(summary.step_length_max_m, step.length_m);
  }
  if (measuring_) summary.slip_distance_m = plant.slip_distance_m() - slip_before_m_;
  summary.heap_allocations_in_loop = heap_allocations;
  summary.controller_bytes = SimulatedController::bytes();
  summarise_solves();
}

}  // namespace stilt::simulation
