#include "firmware/control_loop/control_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware/control_loop/sensor_reading.h"
#include "firmware/control_loop/trace_points.h"

// One control loop for robot, simulation and replay: docs/decisions/0015-one-control-loop.md
namespace stilt::control_loop {
namespace {

using model::kJoints;
using supervisor::FallbackLevel;
using supervisor::State;

supervisor::JointLimits joint_limits(const model::RobotConstants& robot) noexcept {
  supervisor::JointLimits limits;
  for (std::size_t i = 0; i < hal::kJoints; ++i) {
    limits.position_min_rad[i] = robot.position_min_rad[i];
    limits.position_max_rad[i] = robot.position_max_rad[i];
    limits.speed_rad_s[i] = robot.velocity_limit_rad_s[i];
    limits.torque_Nm[i] = robot.torque_limit_Nm[i];
  }
  return limits;
}

std::uint64_t error_count(const hal::RobotReadings& readings) noexcept {
  std::uint64_t count = readings.bus_errors + readings.base.malformed;
  for (const hal::JointReading& joint : readings.joints) count += joint.malformed;
  return count;
}

hal::JointCommands feed_forward(const model::JointVector& torque_Nm, const hal::RobotReadings& readings,
                                const supervisor::JointLimits& limits) noexcept {
  hal::JointCommands commands{};
  for (std::size_t i = 0; i < hal::kJoints; ++i) {
    commands[i].position_rad = readings.joints[i].position_rad;
    commands[i].torque_Nm = torque_Nm[static_cast<int>(i)];
    commands[i].torque_limit_Nm = limits.torque_Nm[i];
  }
  return commands;
}

}  // namespace

void ControlLoop::configure(const model::RobotModel& robot, const control::ControllerParameters& parameters,
                            const supervisor::SupervisorParameters& supervision) noexcept {
  model_ = &robot;
  limits_ = joint_limits(robot.constants);
  supervision_ = supervision;
  standing_ = StandingPose(robot, parameters);
  calm_m_s_ = parameters.gait.catch_calm_m_s;
  supervisor_.configure(limits_, supervision);
  estimator_.configure(robot, parameters.estimator);
  law_.configure(robot, parameters);
  blend_.configure(supervision.torque_blend_s);
  gait_.configure(robot, parameters, supervision, nullptr);
}

void ControlLoop::attach(hal::Robot& robot, Mailboxes& mailboxes) noexcept {
  robot_ = &robot;
  mail_ = &mailboxes;
}

void ControlLoop::begin_standing(std::int64_t now_ns, const gait::GaitCommand& command,
                                 const model::StateVector* known_state) noexcept {
  supervisor_.begin_standing(now_ns);
  blend_.remember({FallbackLevel::plan, tuning_});
  const control::SensorReading reading = read(now_ns);
  request_plan(reading.time_s, begin_stance_episode(reading, known_state), command);
}

void ControlLoop::tick(const TickTiming& timing, const model::StateVector* known_state) noexcept {
  trace::tick_begin(ticks_, timing.now_ns, timing.wakeup_latency_ns);
  take_tuning();
  const OperatorCommand command = mail_->stops.merged_into(mail_->commands.newest());
  const PlanningResult& result = mail_->results.newest();

  const control::SensorReading reading = read(timing.now_ns);
  const PlanView plan = plan_at(reading.time_s);
  model::StateVector estimate = estimate_state(reading, plan, known_state);
  const supervisor::Followable followable = track_gait(reading, plan);
  const supervisor::Observation seen = observe(timing, command, result, reading, plan, estimate, followable);
  const supervisor::SupervisorOutput& decision = supervise(seen, command, reading, at_rest(plan, estimate));
  if (decision.start_controller) estimate = begin_stance_episode(reading, known_state);
  const hal::JointCommands wanted = torques(decision.level, reading, plan, estimate);
  const supervisor::Action action = supervisor_.bound(wanted, commands_);
  send(action, timing.now_ns);

  request_plan(reading.time_s, estimate, decision.gait);
  record(timing, command, result, plan, estimate, wanted, action);
  report_events(seen);
  trace::tick_end(ticks_, static_cast<int>(decision.state), static_cast<int>(decision.level));
  ++ticks_;
}

void ControlLoop::take_tuning() noexcept {
  if (!mail_->torque_tunings.has_news()) return;
  const TorqueTuning& tuning = mail_->torque_tunings.newest();
  law_.tune(tuning.law);
  tuning_ = tuning.number;
}

control::SensorReading ControlLoop::read(std::int64_t now_ns) noexcept {
  if (ticks_ == 0) start_ns_ = now_ns;
  last_time_s_ = time_s_;
  time_s_ = 1e-9 * static_cast<double>(now_ns - start_ns_);
  robot_->read(now_ns, readings_);
  asked_Nm_ = commanding_ ? supervisor::asked_torque_Nm(commands_, readings_.joints) : hal::JointValues{};
  return sensor_reading(time_s_, readings_, now_ns);
}

/// The one look at the plans in a tick: the next plan may be published at any time. A plan of an earlier
/// stance episode was made from another place. After a gait a plan is followed again only with the gait's
/// foot on the ground.
ControlLoop::PlanView ControlLoop::plan_at(double time_s) const noexcept {
  const control::Plan& plan = mail_->plans.newest();
  const bool of_episode = episode_ != 0 && plan.nodes >= 2 && plan.start_time_s >= episode_start_s_;
  PlanView view;
  view.sequence = plan.sequence;
  view.age_s = time_s - (of_episode ? plan.start_time_s : episode_start_s_);
  if (!of_episode || time_s > plan.node[plan.nodes - 1].time_s) return view;
  const control::PlanNode& last = plan.node[plan.nodes - 1];
  view.stands = plan.gait == gait::GaitKind::stand && plan.phase_end_s >= last.time_s;
  view.end = last.state.head<3>();
  view.point = control::interpolate(plan, time_s);
  view.exists = supervisor_.output().level != FallbackLevel::gait || view.point.mode == gait_.contact();
  view.use = supervisor::plan_use(view.exists, view.age_s, supervision_);
  if (view.exists && view.use == supervisor::PlanUse::none &&
      gait_.awaits_touch_down(plan, time_s, view.point.mode)) {
    view.use = supervisor::PlanUse::with_feedback;
  }
  const control::PlanPoint before = control::interpolate(plan, last_time_s_);
  view.velocity_change = (view.point.state - before.state).segment<2>(model::kPositions);
  return view;
}

/// The feet on the ground are the plan's, without one the gait's. A known state replaces the sensors and the
/// base's position. The base's velocity stays that of the feet on the ground, which the plan is made for
/// (docs/decisions/0037-feasible-plans.md).
model::StateVector ControlLoop::estimate_state(const control::SensorReading& sensors, const PlanView& plan,
                                               const model::StateVector* known_state) noexcept {
  const bool is_known = known_state != nullptr;
  if (episode_ == 0) return is_known ? *known_state : measured_state(sensors);
  const control::SensorReading reading = is_known ? exact_reading(sensors.time_s, *known_state) : sensors;
  model::ContactMode contact{true, true};
  if (plan.exists) {
    contact = plan.point.mode;
  } else if (gait_.ready()) {
    contact = gait_.contact();
  }
  const bool is_planned = plan.use != supervisor::PlanUse::none;
  model::StateVector estimate =
      estimator_.update(reading, contact, is_planned ? &plan.velocity_change : nullptr);
  if (is_known) estimate.head<2>() = known_state->head<2>();
  return estimate;
}

/// The gait keeps in step with a robot that steps, whatever commands it. It goes on until there is a plan
/// with its foot on the ground, as long as plans come.
supervisor::Followable ControlLoop::track_gait(const control::SensorReading& reading,
                                               const PlanView& plan) noexcept {
  const supervisor::SupervisorOutput& decision = supervisor_.output();
  const bool waits_for_plan = decision.state == State::stand && decision.level == FallbackLevel::gait &&
                              plan.use == supervisor::PlanUse::none && plan.age_s < supervision_.stale_plan_s;
  if (decision.state != State::step && decision.state != State::walk && !waits_for_plan) {
    gait_.forget(reading.time_s);
    return {.plan = plan.use};
  }
  const model::ContactMode* planned = plan.use != supervisor::PlanUse::none ? &plan.point.mode : nullptr;
  gait_.tick(reading, {planned, plan.age_s}, decision.gait.speed_m_s);
  return {.plan = plan.use, .gait = gait_.ready(), .gait_selected = gait_.selected()};
}

supervisor::Observation ControlLoop::observe(const TickTiming& timing, const OperatorCommand& command,
                                             const PlanningResult& result,
                                             const control::SensorReading& reading, const PlanView& plan,
                                             const model::StateVector& estimate,
                                             const supervisor::Followable& followable) noexcept {
  const std::uint64_t errors = error_count(readings_);
  const bool of_episode = result.stance_episode == episode_ && episode_ != 0;
  supervisor::Observation seen;
  seen.time_ns = timing.now_ns;
  seen.joints = readings_.joints;
  seen.base = readings_.base;
  seen.read_status = readings_.status;
  seen.write_status = write_status_;
  seen.bus_errors = errors > errors_;
  seen.buses = readings_.buses;
  seen.emergency_stop = readings_.emergency_stop;
  const PlannedJoints planned = planned_joints(plan);
  seen.planned_speed_rad_s = planned.speed_rad_s;
  if (supervisor::has_torque(supervisor_.output().state)) {
    seen.signals =
        monitor_.update({timing.now_ns, readings_.joints, readings_.base, asked_Nm_, planned.position_rad});
  } else {
    monitor_.reset();
  }
  if (episode_ != 0) seen.hip_height_share = hip_height_share(*model_, reading);
  seen.controller_finite = torques_finite_ && (episode_ == 0 || estimate.allFinite());
  seen.followable = followable;
  seen.failed_solves = of_episode ? static_cast<int>(result.failures_in_a_row) : 0;
  seen.solve_s = of_episode ? 1e-9 * static_cast<double>(result.solve_ns) : 0.0;
  seen.plan_age_s = episode_ != 0 ? plan.age_s : 0.0;
  seen.wakeup_latency_s = 1e-9 * static_cast<double>(timing.wakeup_latency_ns);
  seen.tick_gap_s = time_s_ - last_time_s_;
  seen.heartbeat_expected = command.heartbeat_expected;
  seen.heartbeat_age_s = 1e-9 * static_cast<double>(timing.now_ns - command.heartbeat_ns);
  seen.bring_up_failed = bring_up_.failed;
  errors_ = errors;
  return seen;
}

ControlLoop::PlannedJoints ControlLoop::planned_joints(const PlanView& plan) const noexcept {
  PlannedJoints planned{};
  planned.position_rad.fill(std::numeric_limits<double>::quiet_NaN());
  if (supervisor_.output().level == FallbackLevel::sit) {
    for (std::size_t i = 0; i < hal::kJoints; ++i) planned.position_rad[i] = commands_[i].position_rad;
  }
  if (supervisor_.output().ramp < 1.0) return planned;
  const auto take = [&planned](const model::JointVector& position_rad,
                               const model::JointVector& speed_rad_s) {
    std::copy_n(position_rad.data(), planned.position_rad.size(), planned.position_rad.begin());
    std::copy_n(speed_rad_s.data(), planned.speed_rad_s.size(), planned.speed_rad_s.begin());
  };
  if (supervisor_.output().level == FallbackLevel::gait) {
    take(gait_.position_rad(), gait_.velocity_rad_s());
  } else if (plan.exists) {
    take(plan.point.state.segment<kJoints>(model::kFirstJoint), plan.point.state.tail<kJoints>());
  }
  return planned;
}

/// A robot that shall sit must not be in a step, nor recover from a push. At the turn of a sway it is slow,
/// too, but its plan goes on.
bool ControlLoop::at_rest(const PlanView& plan, const model::StateVector& estimate) const noexcept {
  constexpr double kNear = 0.03;  // m, and rad of pitch
  return plan.stands && plan.use != supervisor::PlanUse::none &&
         std::abs(estimate[model::kPositions]) <= calm_m_s_ &&
         (estimate.head<3>() - plan.end).cwiseAbs().maxCoeff() <= kNear;
}

const supervisor::SupervisorOutput& ControlLoop::supervise(const supervisor::Observation& seen,
                                                           const OperatorCommand& command,
                                                           const control::SensorReading& reading,
                                                           bool rests) noexcept {
  stand_miss_ = standing_.miss(reading, supervision_.stand_pose_margin_rad);
  if (stand_miss_.none()) stand_miss_ = too_fast(reading, supervision_.stand_speed_rad_s);
  stance_miss_ = standing_.miss(reading, supervision_.stance_margin_rad);
  const supervisor::SupervisorOutput& decision = supervisor_.update({.seen = seen,
                                                                     .request = command.request,
                                                                     .bring_up_done = bring_up_.ready,
                                                                     .shut_down = command.shut_down,
                                                                     .fit_to_stand = stand_miss_.none(),
                                                                     .in_stance = stance_miss_.none(),
                                                                     .at_rest = rests});
  if (decision.clear_buses) robot_->restore_buses();
  if (decision.entered && decision.state == State::calibrate) {
    bring_up_ = {};
    robot_->begin_bring_up();
  }
  if (!supervisor::tracks(decision.state)) episode_ = 0;
  return decision;
}

model::StateVector ControlLoop::begin_stance_episode(const control::SensorReading& reading,
                                                     const model::StateVector* known_state) noexcept {
  episode_ = ++episodes_;
  episode_start_s_ = reading.time_s;
  estimator_.reset(reading, 0.0);
  return known_state != nullptr ? *known_state : estimator_.update(reading, {true, true});
}

hal::JointCommands ControlLoop::torques(FallbackLevel level, const control::SensorReading& reading,
                                        const PlanView& plan, const model::StateVector& estimate) noexcept {
  torques_finite_ = true;
  model::JointVector torque_Nm = model::JointVector::Zero();
  if (level == FallbackLevel::gait) torque_Nm = gait_.torque_Nm();
  if (level <= FallbackLevel::plan_feedback) {
    const control::TorqueCommand torque = law_.follow(reading, estimate, plan.point);
    torques_finite_ = torque.finite;
    torque_Nm = torque.torque_Nm;
  }
  hal::JointCommands wanted = feed_forward(torque_Nm, readings_, limits_);
  const TorqueBlend::Law law{level, tuning_};
  if (level <= FallbackLevel::gait && supervisor_.output().ramp >= 1.0) {
    blend_.fade(law, reading.time_s, asked_Nm_, wanted);
  } else {
    blend_.remember(law);
  }
  return wanted;
}

void ControlLoop::send(supervisor::Action action, std::int64_t now_ns) noexcept {
  commanding_ = action == supervisor::Action::commands;
  switch (action) {
    case supervisor::Action::commands:
      write_status_ = robot_->write(commands_);
      break;
    case supervisor::Action::disable:
      write_status_ = robot_->disable();
      break;
    case supervisor::Action::silent:
      write_status_ = hal::JointBusStatus::ok;
      if (supervisor_.output().state == State::calibrate) bring_up(now_ns);
      break;
  }
}

void ControlLoop::bring_up(std::int64_t now_ns) noexcept {
  bring_up_ = robot_->bring_up(now_ns);
  if (!bring_up_.failed) return;
  push({.kind = Event::Kind::bring_up_failed, .bring_up = bring_up_});
}

void ControlLoop::request_plan(double time_s, const model::StateVector& estimate,
                               const gait::GaitCommand& command) noexcept {
  PlanningRequest& request = mail_->requests.writer();
  request.tick = ticks_;
  request.time_s = time_s;
  request.stance_episode = episode_;
  request.state = estimate;
  request.command = command;
  request.tracked = {};
  if (supervisor_.output().level == FallbackLevel::gait) request.tracked = gait_.step();
  mail_->requests.publish();
}

}  // namespace stilt::control_loop
