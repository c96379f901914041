#include "host_tools/recording/run/tick_run.h"

#include <algorithm>
#include <cmath>

namespace stilt::record {
namespace {

constexpr std::uint64_t kTicksPerSample = 5;
constexpr double kPlannedStance_N = 100.0;  // stands for the force of a foot that is planned to stand

/// Forces from which touch-downs are found: measured ones, else those of the plan's contacts. Nothing without
/// either.
std::optional<model::FeetVector> forces_for_steps(const log::RunSample& sample,
                                                  const std::optional<PlanTrack::Point>& plan) {
  model::FeetVector forces = sample.contact_force_N;
  forces[0] = forces[2] = 0.0;
  if (std::isfinite(forces[1]) && std::isfinite(forces[3])) return forces;
  if (!plan) return std::nullopt;
  forces[1] = plan->mode.left ? kPlannedStance_N : 0.0;
  forces[3] = plan->mode.right ? kPlannedStance_N : 0.0;
  return forces;
}

bool walks(supervisor::State state) {
  return state == supervisor::State::step || state == supervisor::State::walk;
}

/// The estimate of a tick. All of it is unknown before the first readings. Off its feet the robot has no
/// place of its hip, which is put at 0 then, and no rates of it.
model::StateVector estimate_of(const control_loop::TickRecord& tick) {
  model::StateVector state = Eigen::Map<const model::StateVector>(tick.estimated_state.data());
  if (state.isZero(0.0)) state.setConstant(kUnknown);
  if (tick.stance_episode == 0) {
    state.head<model::kFirstAngle>().setConstant(kUnknown);
    state.segment<model::kFirstAngle>(model::kPositions).setConstant(kUnknown);
  }
  return state;
}

}  // namespace

void summarise_steps(const std::vector<log::Step>& steps, log::RunSummary& summary) {
  summary.steps = steps;
  if (steps.empty()) return;
  const auto [shortest, longest] = std::ranges::minmax_element(steps, {}, &log::Step::length_m);
  summary.step_length_min_m = shortest->length_m;
  summary.step_length_max_m = longest->length_m;
}

TickRun::TickRun(const model::RobotConstants& robot, std::int64_t start_ns, const PlanTrack& plans,
                 log::RunRecord& run)
    : leg_{robot.thigh_length_m, robot.shin_length_m}, start_ns_(start_ns), plans_(plans), run_(run) {
  run_.summary.peak_torque_Nm.setConstant(kUnknown);
  run_.summary.peak_joint_speed_rad_s.setConstant(kUnknown);
}

void TickRun::add(const control_loop::TickRecord& tick) {
  const double time_s = 1e-9 * static_cast<double>(tick.time_ns - start_ns_);
  const auto plan = tick.plan_sequence >= 0 ? plans_.at(time_s) : std::nullopt;
  log::RunSample sample = sample_of(time_s, tick, plan);
  note_break(time_s, tick);
  note(time_s, tick, sample);
  const auto forces_N = tick.stance_episode > 0 ? forces_for_steps(sample, plan) : std::nullopt;
  if (forces_N) {
    steps_.update(time_s, *forces_N, sample.foot_position_m, sample.estimated_state[0]);
  } else {
    steps_.forget_swings();
    if (walks(tick.state)) run_.summary.steps_known = false;
  }
  if (run_.samples.empty() || tick.tick % kTicksPerSample == 0) run_.samples.push_back(std::move(sample));
}

void TickRun::finish() {
  log::RunSummary& summary = run_.summary;
  summary.survived = last_state_ != supervisor::State::fault;
  summary.duration_s = last_s_ - first_s_;
  summary.distance_m = distance_m_.value_or(kUnknown);
  summary.mean_speed_m_s = walked_s_ > 0.0 ? walked_m_ / walked_s_ : kUnknown;
  summary.slip_distance_m = kUnknown;
  summarise_steps(steps_.steps(), summary);
  run_.controller->last_state = supervisor::name(last_state_);
}

log::RunSample TickRun::sample_of(double time_s, const control_loop::TickRecord& tick,
                                  const std::optional<PlanTrack::Point>& plan) const {
  log::RunSample sample;
  sample.time_s = time_s;
  sample.true_state.setConstant(kUnknown);
  sample.estimated_state = estimate_of(tick);
  sample.planned_state.setConstant(kUnknown);
  sample.planned_contact_force_N.setConstant(kUnknown);
  sample.contact_force_N << kUnknown, tick.base.left_foot_force_N, kUnknown, tick.base.right_foot_force_N;
  for (std::size_t i = 0; i < hal::kJoints; ++i) {
    sample.torque_Nm[static_cast<Eigen::Index>(i)] = tick.joints[i].torque_Nm;
  }
  sample.foot_position_m = simulation::foot_positions(leg_, sample.estimated_state);
  sample.push_N = 0.0;
  sample.commanded_speed_m_s = tick.gait.kind == gait::GaitKind::walk ? tick.gait.speed_m_s : 0.0;
  if (!plan) return sample;
  sample.planned_state.head<3>() << plan->base_x_m, plan->base_z_m, plan->pitch_rad;
  sample.planned_state.segment<model::kJoints>(model::kFirstJoint) = plan->joint_position_rad;
  sample.planned_contact_force_N = plan->contact_force_N;
  sample.scheduled_mode = plan->mode;
  return sample;
}

void TickRun::note_break(double time_s, const control_loop::TickRecord& tick) {
  const std::uint64_t next = last_tick_ + 1;
  last_tick_ = tick.tick;
  if (!begun_ || tick.tick <= next) return;
  const double tick_s = (time_s - last_s_) / static_cast<double>(tick.tick + 1 - next);
  run_.missing_ticks.push_back({next, tick.tick - 1, last_s_ + tick_s, time_s - tick_s});
  if (time_s - last_s_ < simulation::StepDetector::kShortestSwing_s) return;
  steps_.forget_swings();
  run_.summary.steps_known = false;
}

/// In each stance episode the estimate's hip starts at 0 again.
void TickRun::note(double time_s, const control_loop::TickRecord& tick, const log::RunSample& sample) {
  const double x_m = sample.estimated_state[0];
  if (!begun_) first_s_ = time_s;
  begun_ = true;
  if (tick.stance_episode > 0 && tick.stance_episode == episode_) {
    distance_m_ = distance_m_.value_or(0.0) + x_m - last_x_m_;
    if (tick.state == supervisor::State::walk && last_state_ == supervisor::State::walk) {
      walked_m_ += x_m - last_x_m_;
      walked_s_ += time_s - last_s_;
    }
  }
  episode_ = tick.stance_episode;
  if (tick.state != supervisor::State::off) last_state_ = tick.state;
  last_s_ = time_s;
  last_x_m_ = x_m;
  log::RunSummary& summary = run_.summary;
  for (Eigen::Index i = 0; i < model::kJoints; ++i) {
    const hal::JointReading& joint = tick.joints[static_cast<std::size_t>(i)];
    summary.peak_torque_Nm[i] = std::fmax(summary.peak_torque_Nm[i], std::abs(joint.torque_Nm));
    summary.peak_joint_speed_rad_s[i] =
        std::fmax(summary.peak_joint_speed_rad_s[i], std::abs(joint.velocity_rad_s));
  }
}

}  // namespace stilt::record
