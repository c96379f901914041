#include "synthetic_source.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "firmware/supervisor/fallback.h"
#include "firmware/supervisor/fault.h"
#include "firmware/supervisor/state.h"
#include "mpc_core/model/robot.h"
#include "tests/robots.h"

namespace stilt::monitor {
namespace {

using supervisor::State;

constexpr double kTick_s = 0.001;
constexpr double kStep_s = 0.3;
constexpr double kAcceleration_m_s2 = 1.0;

int number(State state) { return static_cast<int>(state); }

/// Hip and knee angle of a leg whose foot is dx ahead of and dz above the hip.
std::array<double, 2> leg_angles(double dx, double dz) {
  const auto& robot = testing_support::amber3m().constants;
  const double a = robot.thigh_length_m, b = robot.shin_length_m;
  const double reach = std::min(std::hypot(dx, dz), 0.999 * (a + b));
  const double knee = std::acos(std::clamp((reach * reach - a * a - b * b) / (2 * a * b), -1.0, 1.0));
  const double hip = std::atan2(-dx, -dz) - std::atan2(b * std::sin(knee), a + b * std::cos(knee));
  return {hip, knee};
}

/// Foot at `phase` of its stride (0 to 1 on the ground, 1 to 2 in the air), relative to the hip's place.
std::array<double, 2> foot_at(double phase, double speed_m_s, double lift_m, double stand_m) {
  const double half = 0.5 * speed_m_s * kStep_s;
  if (phase < 1.0) return {stand_m + half - 2 * half * phase, 0.0};
  const double swing = phase - 1.0;
  const double eased = 0.5 - 0.5 * std::cos(std::numbers::pi * swing);
  return {stand_m - half + 2 * half * eased, lift_m * std::sin(std::numbers::pi * swing)};
}

std::uint64_t bit_of(const std::string& name) {
  for (std::size_t row = 0; row < supervisor::kFaults; ++row) {
    if (name == supervisor::kFaultTable[row].name) return std::uint64_t{1} << row;
  }
  throw std::invalid_argument("no fault is called " + name);
}

}  // namespace

SyntheticSource::SyntheticSource() { publish_event("state: stand", false); }

void SyntheticSource::publish_event(const std::string& text, bool serious) {
  events_.push_back({static_cast<double>(ticks_) * kTick_s, text, serious});
}

void SyntheticSource::advance(double now_s) {
  if (start_s_ < 0.0) start_s_ = now_s;
  now_s_ = now_s;
}

void SyntheticSource::change(const std::string& words) {
  std::istringstream stream(words);
  std::string verb, argument;
  stream >> verb >> argument;
  if (verb == "silent") {
    silent_ = true;
  } else if (verb == "talk") {
    silent_ = false;
  } else if (verb == "fault") {
    const std::uint64_t bit = bit_of(argument);
    present_ |= bit;
    if (supervisor::of_severity(supervisor::Severity::latched).bits() & bit) latched_ |= bit;
    const bool falls = supervisor::reaction(supervisor::FaultSet(latched_)) > supervisor::Reaction::sit;
    if (falls) state_ = number(State::fault);
    std::getline(stream >> std::ws, found_[argument]);
    publish_event("fault: " + argument, true);
  } else if (verb == "event") {
    std::string more;
    std::getline(stream, more);
    publish_event(argument + more, false);
  } else if (verb == "over") {
    present_ &= ~bit_of(argument);
  } else if (verb == "drop") {
    ticks_ += std::stoull(argument);
  } else if (verb == "run") {
    begin_run(run_id_ + 1);
  } else if (verb == "others") {
    other_run_id_ = 77;
  } else if (verb == "push") {
    push_N_ = std::stod(argument);
  } else if (verb == "idle") {
    state_ = number(State::idle);
  } else if (verb == "dead") {
    joints_answer_ = false;
  } else if (verb == "forge") {
    std::getline(stream, forged_);
    forged_ = argument + forged_;
  } else if (verb == "answer") {
    forged_.clear();
    for (; !kept_back_.empty(); kept_back_.pop_front()) replies_.push_back(kept_back_.front());
  } else if (verb == "record") {
    live_ = false;
  } else {
    throw std::invalid_argument("not understood: " + words);
  }
}

void SyntheticSource::begin_run(int run_id) {
  run_id_ = run_id;
  ticks_ = 0;
  start_s_ = now_s_;
  introduce_ = true;
}

std::vector<SendingRun> SyntheticSource::talking() const {
  std::vector<SendingRun> all = {{run(), "amber3m"}};
  if (other_run_id_ != 0) all.push_back({"synthetic-" + std::to_string(other_run_id_), "amber3m"});
  return all;
}

void SyntheticSource::choose(const std::string& run_id) {
  if (run_id != "synthetic-" + std::to_string(other_run_id_)) return;
  begin_run(std::exchange(other_run_id_, run_id_));
}

void SyntheticSource::poll(SampleSink& sink) {
  if (introduce_) introduce(sink);
  introduce_ = false;
  for (; !replies_.empty(); replies_.pop_front()) sink.reply(replies_.front());
  if (silent_) return;
  for (; !events_.empty(); events_.pop_front()) sink.event(events_.front());
  const double until_s = now_s_ - start_s_;
  for (int k = 0; k < 2000 && static_cast<double>(ticks_) * kTick_s < until_s; ++k) tick(sink);
}

std::string SyntheticSource::refusal(const Command& command) const {
  const bool with_several = command.with_known_tokens && telemetry::is_of_everybody(command.kind);
  if (!command.token.empty() && command.token != kToken && !with_several) {
    return "The token is not that of this run.";
  }
  const bool fast = std::abs(command.value) > 1.0;
  if ((command.kind == CommandKind::walk || command.kind == CommandKind::speed) && fast) {
    return "The speed must be -1 to 1 m/s.";
  }
  if (command.kind == CommandKind::height && (command.value < 0.72 || command.value > 0.82)) {
    return "The hip height must be 0.72 to 0.82 m.";
  }
  if (command.kind == CommandKind::tunable && (command.value < 0.005 || command.value > 0.3)) {
    return "gait.swing_height_m must be 0.005 to 0.3 m.";
  }
  if (state_ == number(State::fault) && command.kind != CommandKind::reset &&
      command.kind != CommandKind::stop && command.kind != CommandKind::cut) {
    return "A fault waits for a reset.";
  }
  return {};
}

void SyntheticSource::command(const Command& command) {
  const std::string why = refusal(command);
  if (why.empty()) apply(command);
  if (command.kind == CommandKind::heartbeat) return;
  const ReplySample reply{command.commander, command.sequence, why.empty(), why};
  if (forged_.empty()) {
    replies_.push_back(reply);
  } else {
    replies_.push_back({command.commander, command.sequence, false, forged_, false});
    kept_back_.push_back(reply);
  }
}

void SyntheticSource::apply(const Command& command) {
  const int before = state_;
  switch (command.kind) {
    case CommandKind::walk:
    case CommandKind::speed:
      if (command.kind == CommandKind::walk) state_ = number(State::walk);
      wanted_m_s_ = command.value;
      break;
    case CommandKind::step:
      state_ = number(State::step);
      wanted_m_s_ = 0.0;
      break;
    case CommandKind::stand:
    case CommandKind::stop:
      if (latched_ == 0) state_ = number(State::stand);
      wanted_m_s_ = 0.0;
      break;
    case CommandKind::cut:
      state_ = number(State::off);
      wanted_m_s_ = 0.0;
      break;
    case CommandKind::reset:
      latched_ = present_;
      if (latched_ == 0) state_ = number(State::stand);
      break;
    case CommandKind::height:
      hip_height_m_ = command.value;
      introduce_ = true;
      break;
    case CommandKind::tunable:
      swing_height_m_ = command.value;
      introduce_ = true;
      break;
    default:
      break;
  }
  if (state_ != before) publish_event(std::string("state: ") + name(static_cast<State>(state_)), false);
}

void SyntheticSource::tick(SampleSink& sink) {
  const double change =
      std::clamp(wanted_m_s_ - speed_m_s_, -kAcceleration_m_s2 * kTick_s, kAcceleration_m_s2 * kTick_s);
  speed_m_s_ += change;
  base_x_m_ += speed_m_s_ * kTick_s;
  const bool steps =
      state_ == number(State::walk) || state_ == number(State::step) || std::abs(speed_m_s_) > 0.01;
  if (steps) phase_ = std::fmod(phase_ + kTick_s / kStep_s, 2.0);
  TickSample sample;
  control_loop::TickRecord& record = sample.record;
  record.tick = ticks_;
  sample.time_s = static_cast<double>(ticks_) * kTick_s;
  const PlanNodeSample now = node(0.0);
  record.estimated_state = {now.base_x_m, now.base_z_m, now.pitch_rad};
  record.estimated_state[7] = speed_m_s_ + 0.03 * std::sin(2 * std::numbers::pi * phase_);
  for (std::size_t foot = 0; foot < 2; ++foot) {
    const auto angles = leg_angles(now.foot_position_m[2 * foot] - now.base_x_m,
                                   now.foot_position_m[2 * foot + 1] - now.base_z_m);
    for (std::size_t k = 0; k < 2; ++k) {
      const std::size_t joint = 2 * foot + k;
      record.estimated_state[3 + joint] = angles[k] - (k == 0 ? now.pitch_rad : 0.0);
      record.wanted[joint].position_rad = record.estimated_state[3 + joint] + 0.01;
      record.sent[joint].torque_limit_Nm = 80.0;
      record.sent[joint].torque_Nm =
          30.0 * std::sin(std::numbers::pi * (phase_ + static_cast<double>(joint)));
      record.joints[joint].position_rad = record.estimated_state[3 + joint];
      record.joints[joint].velocity_rad_s = 0.0;
      record.joints[joint].missed_replies = joints_answer_ ? 0 : 5000;
      record.joints[joint].torque_Nm = record.sent[joint].torque_Nm;
    }
  }
  record.ramp = 1.0;
  record.stance_episode = state_ == number(State::fault) || state_ == number(State::idle) ? 0 : 1;
  record.plan_age_s = 0.005 + kTick_s * static_cast<double>(ticks_ % 10);
  record.wakeup_latency_ns = 20'000 + std::lround(15e3 * std::sin(static_cast<double>(ticks_)));
  record.execution_ns = 35'000 + std::lround(5e3 * std::cos(1.3 * static_cast<double>(ticks_)));
  record.bus_round_trip_ns = 180'000;
  record.action = supervisor::Action::commands;
  record.state = static_cast<supervisor::State>(state_);
  record.gait = commanded_gait();
  sink.tick(sample);
  if (ticks_ % 10 == 0) {
    const double wave = std::sin(0.1 * static_cast<double>(ticks_));
    sink.planner({ticks_ / 10, sample.time_s, 0, 4 + static_cast<int>(std::lround(wave)), 1e-5 * (2 + wave),
                  1e-7, 12.0, 420.0 + 60.0 * wave});
  }
  ++ticks_;
  if (ticks_ % 33 == 0) say_slowly(sink);
}

void SyntheticSource::say_slowly(SampleSink& sink) {
  PlanSample plan;
  plan.time_s = static_cast<double>(ticks_) * kTick_s;
  for (int k = 0; k < 60; ++k) plan.nodes.push_back(node(0.02 * k));
  sink.plan(plan);
  sink.supervisor(supervisor_sample());
  if (push_N_ != 0.0) {
    TruthSample truth;
    truth.time_s = plan.time_s;
    truth.contact_force_N = plan.nodes.front().contact_force_N;
    truth.push_N = push_N_;
    sink.truth(truth);
  }
  if (ticks_ % 990 == 0) sink.timing(timing_sample());
}

PlanNodeSample SyntheticSource::node(double ahead_s) const {
  const bool steps =
      state_ == number(State::walk) || state_ == number(State::step) || std::abs(speed_m_s_) > 0.01;
  const double phase = steps ? std::fmod(phase_ + ahead_s / kStep_s, 2.0) : 0.0;
  PlanNodeSample node;
  node.time_s = static_cast<double>(ticks_) * kTick_s + ahead_s;
  node.base_x_m = base_x_m_ + speed_m_s_ * ahead_s;
  node.base_z_m = hip_height_m_ - (steps ? 0.012 * std::cos(2 * std::numbers::pi * phase) : 0.0);
  node.pitch_rad = 0.05 * speed_m_s_ + (steps ? 0.02 * std::sin(std::numbers::pi * phase) : 0.0);
  for (std::size_t foot = 0; foot < 2; ++foot) {
    const double own = std::fmod(phase + static_cast<double>(foot), 2.0);
    const auto place = steps ? foot_at(own, speed_m_s_, swing_height_m_, foot == 0 ? 0.02 : -0.02)
                             : std::array<double, 2>{foot == 0 ? 0.15 : -0.15, 0.0};
    node.foot_position_m[2 * foot] = node.base_x_m + place[0];
    node.foot_position_m[2 * foot + 1] = place[1];
    const bool stance = !steps || own < 1.0;
    (foot == 0 ? node.left_stance : node.right_stance) = stance;
    node.contact_force_N[2 * foot] = stance && steps ? 20.0 - 40.0 * own : 0.0;
    node.contact_force_N[2 * foot + 1] = stance ? (steps ? 220.0 : 110.0) : 0.0;
  }
  return node;
}

gait::GaitCommand SyntheticSource::commanded_gait() const {
  if (state_ == number(State::walk)) return {gait::GaitKind::walk, wanted_m_s_};
  return {state_ == number(State::step) ? gait::GaitKind::step : gait::GaitKind::stand, 0.0};
}

SupervisorSample SyntheticSource::supervisor_sample() const {
  SupervisorSample sample;
  sample.time_s = static_cast<double>(ticks_) * kTick_s;
  sample.state = state_;
  sample.fallback_level = static_cast<int>(state_ == number(State::fault) ? supervisor::FallbackLevel::damp
                                                                          : supervisor::FallbackLevel::plan);
  sample.present = present_;
  sample.latched = latched_;
  sample.ramp = 1.0;
  sample.gait = static_cast<int>(commanded_gait().kind);
  sample.speed_m_s = commanded_gait().speed_m_s;
  sample.base_height_m = hip_height_m_;
  sample.found = found_;
  return sample;
}

TimingSample SyntheticSource::timing_sample() const {
  HistogramSample wakeup{"wakeup_latency", 500.0, 21.0, 60.0, 130.0, 180.0, ticks_, {}, {}};
  HistogramSample solve{"solve", 10000.0, 420.0, 480.0, 490.0, 500.0, ticks_ / 10, {}, {}};
  for (double edge_us = 4.0; edge_us < 200.0; edge_us *= 1.1) {
    const double width = std::log(edge_us / 21.0) / 0.7;
    wakeup.upper_edge_us.push_back(edge_us);
    wakeup.in_bin.push_back(static_cast<std::uint64_t>(2000.0 * std::exp(-width * width)));
    solve.upper_edge_us.push_back(20.0 * edge_us);
    solve.in_bin.push_back(wakeup.in_bin.back() / 10);
  }
  return {ticks_, 3, 0, {wakeup, solve}};
}

void SyntheticSource::introduce(SampleSink& sink) {
  ConfigurationSample sample;
  sample.run_id = run();
  sample.robot = "amber3m";
  sample.build = "a test";
  sample.toml = "[inequality]\nfriction_coefficient = 0.6\n[supervisor]\ndamped_before_off_s = 3.0\n";
  sample.tunables.push_back(
      {"gait.swing_height_m", "m", "Apex of the swing foot above the ground", 0.005, 0.3, swing_height_m_});
  sample.tunables.push_back(
      {"reference.base_height_m", "m", "Height of the hip above the ground", 0.72, 0.82, hip_height_m_});
  sample.tunables.push_back({"cost.base_z", "1/(m^2 s)", "Height of the hip", 0.0, 1e6, 400.0});
  sink.configuration(sample);
}

}  // namespace stilt::monitor
