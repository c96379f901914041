#include "host_tools/simulation/robot_on_bus/walk_recorder.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host_tools/recording/mean_speed.h"

namespace stilt::robot_on_bus {
namespace {

constexpr double kArrived_m = 0.1;
constexpr long long kTicksASample = 5;

}  // namespace

void WalkRecorder::begin(const simulation::Plant& plant) {
  running_ = true;
  start_x_m_ = plant.state()[0];
  start_slip_m_ = plant.slip_distance_m();
}

void WalkRecorder::observe_step(const simulation::Plant& plant) {
  if (!running_) return;
  log::RunSummary& summary = record_.summary;
  const model::JointVector speed = plant.state().tail<model::kJoints>().cwiseAbs();
  summary.peak_torque_Nm = summary.peak_torque_Nm.cwiseMax(plant.applied_torque_Nm().cwiseAbs());
  summary.peak_joint_speed_rad_s = summary.peak_joint_speed_rad_s.cwiseMax(speed);
  summary.fall_margin_min = std::min(summary.fall_margin_min, plant.fall_margin());
}

void WalkRecorder::observe_tick(double time_s, const simulation::Plant& plant,
                                const simulation::ActingPush& push) {
  if (!running_) return;
  steps_.update(time_s, plant.contact_force_N(), plant.foot_position_m(), plant.state()[0]);
  if (time_s >= log::kSettled_s && ticks_ % kTicksASample == 0) way_.push_back({time_s, plant.state()[0]});
  if (keep_samples_ && ticks_ % kTicksASample == 0) take_sample(time_s, plant, push);
  ++ticks_;
}

void WalkRecorder::take_sample(double time_s, const simulation::Plant& plant,
                               const simulation::ActingPush& push) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const model::StateVector truth = plant.state();
  log::RunSample sample;
  sample.time_s = time_s;
  sample.true_state = truth;
  sample.estimated_state.setConstant(kUnknown);
  sample.planned_state.setConstant(kUnknown);
  sample.torque_Nm = plant.applied_torque_Nm();
  sample.contact_force_N = plant.contact_force_N();
  sample.planned_contact_force_N.setConstant(kUnknown);
  sample.foot_position_m = plant.foot_position_m();
  sample.scheduled_mode = {sample.contact_force_N[1] > 0.0, sample.contact_force_N[3] > 0.0};
  sample.push_N = push.force_N;
  sample.push_above_hip_m = simulation::push_above_hip_m(push.point);
  sample.commanded_speed_m_s = kUnknown;
  record_.samples.push_back(sample);
}

double WalkRecorder::mean_speed_m_s(double time_s, double x_m) const {
  if (way_.empty()) return time_s > 0.0 ? (x_m - start_x_m_) / time_s : 0.0;
  const auto last = std::find_if(way_.rbegin(), way_.rend(), [x_m](const Place& place) {
    return std::abs(x_m - place.x_m) > kArrived_m;
  });
  const Place& from = way_.front();
  const Place to = last == way_.rend() || last->time_s == from.time_s ? Place{time_s, x_m} : *last;
  return to.time_s > from.time_s ? (to.x_m - from.x_m) / (to.time_s - from.time_s) : 0.0;
}

void WalkRecorder::finish(double time_s, const simulation::Plant& plant, simulation::Fall fall) {
  if (!running_) return;
  running_ = false;
  finished_ = true;
  fall_ = fall;
  log::RunSummary& summary = record_.summary;
  summary.survived = fall == simulation::Fall::none;
  summary.fall_time_s = summary.survived ? -1.0 : time_s;
  summary.duration_s = time_s;
  summary.distance_m = plant.state()[0] - start_x_m_;
  summary.mean_speed_m_s = mean_speed_m_s(time_s, plant.state()[0]);
  summary.steps = steps_.steps();
  if (!summary.steps.empty()) {
    const auto [shortest, longest] = std::ranges::minmax_element(summary.steps, {}, &log::Step::length_m);
    summary.step_length_min_m = shortest->length_m;
    summary.step_length_max_m = longest->length_m;
  }
  summary.slip_distance_m = plant.slip_distance_m() - start_slip_m_;
}

}  // namespace stilt::robot_on_bus
