#include "firmware/controller/torque_cycle.h"

#include <algorithm>
#include <cmath>

#include "mpc_core/gait/reference.h"

namespace stilt::controller {
namespace {

using hal::JointBusStatus;
using hal::JointReadings;
using model::kJoints;
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

/// The pitch now: the newest one, carried on with its rate when the base sensor is slower than the torque
/// loop.
double pitch_now_rad(const hal::BaseReading& base, std::int64_t now_ns) noexcept {
  constexpr std::int64_t kLongest_ns = 10'000'000;
  const std::int64_t age_ns = std::clamp<std::int64_t>(now_ns - base.time_ns, 0, kLongest_ns);
  const double change_rad = 1e-9 * static_cast<double>(age_ns) * base.pitch_rate_rad_s;
  return std::isfinite(change_rad) ? base.pitch_rad + change_rad : base.pitch_rad;
}

control::SensorReading sensor_reading(double time_s, const JointReadings& joints,
                                      const hal::BaseReading& base, std::int64_t now_ns) noexcept {
  control::SensorReading reading;
  reading.time_s = time_s;
  for (int i = 0; i < kJoints; ++i) {
    const auto& joint = joints[static_cast<std::size_t>(i)];
    reading.joint_position_rad[i] = joint.position_rad;
    reading.joint_velocity_rad_s[i] = joint.velocity_rad_s;
  }
  reading.base_pitch_rad = pitch_now_rad(base, now_ns);
  reading.base_pitch_rate_rad_s = base.pitch_rate_rad_s;
  return reading;
}

/// What the sensors say of the state; the hip stands still at the origin.
model::StateVector measured_state(const control::SensorReading& reading) noexcept {
  model::StateVector state = model::StateVector::Zero();
  state[model::kFirstAngle] = reading.base_pitch_rad;
  state.segment<kJoints>(model::kFirstJoint) = reading.joint_position_rad;
  state[model::kPositions + model::kFirstAngle] = reading.base_pitch_rate_rad_s;
  state.tail<kJoints>() = reading.joint_velocity_rad_s;
  return state;
}

std::uint64_t malformed(const JointReadings& joints, const hal::BaseReading& base) noexcept {
  std::uint64_t count = base.malformed;
  for (const hal::JointReading& joint : joints) count += joint.malformed;
  return count;
}

}  // namespace

void TorqueCycle::configure(const model::RobotModel& robot, const control::ControllerParameters& parameters,
                            const supervisor::SupervisorParameters& supervision) noexcept {
  limits_ = joint_limits(robot.constants);
  supervision_ = supervision;
  standing_pitch_rad_ = parameters.reference.base_pitch_rad;
  for (const bool left_ahead : {true, false}) {
    standing_rad_[left_ahead ? 0 : 1] =
        gait::standing_state(robot.constants, parameters.reference.base_height_m, standing_pitch_rad_,
                             parameters.gait.stand_half_width_m, left_ahead)
            .segment<kJoints>(model::kFirstJoint);
  }
  supervisor_.configure(limits_, supervision);
  estimator_.configure(robot, parameters.estimator);
  law_.configure(robot, parameters);
  control::ControllerParameters with_feedback = parameters;
  with_feedback.torque_law.use_feedback_gains = true;
  law_of_old_plan_.configure(robot, with_feedback);
  gait_.configure(robot, parameters.robot, nullptr);
}

void TorqueCycle::attach(const Robot& robot, Mailboxes& mailboxes) noexcept {
  robot_ = robot;
  mail_ = &mailboxes;
}

void TorqueCycle::tick(const TickTiming& timing) noexcept {
  take_tuning();
  sense(timing);
  const control::Plan& plan = mail_->plans.newest();
  look_at_plan(plan);
  estimate_state(plan);
  follow_gait(plan);
  supervise();
  const hal::JointCommands wanted = torque_law(plan);
  const supervisor::Action action = supervisor_.override(wanted, commands_);
  act(action);
  ask_for_plan();
  record(timing, wanted, action, plan);
  report_events();
  ++ticks_;
}

void TorqueCycle::take_tuning() noexcept {
  if (!mail_->torque_tunings.has_news()) return;
  const TorqueTuning& tuning = mail_->torque_tunings.newest();
  law_.tune(tuning.law);
  control::TorqueLawParameters with_feedback = tuning.law;
  with_feedback.use_feedback_gains = true;
  law_of_old_plan_.tune(with_feedback);
  record_.tuning = tuning.number;
}

void TorqueCycle::sense(const TickTiming& timing) noexcept {
  const std::int64_t now_ns = timing.now_ns;
  if (ticks_ == 0) start_ns_ = now_ns;
  seen_.time_ns = now_ns;
  seen_.lateness_s = 1e-9 * static_cast<double>(timing.late_ns);
  seen_.read_status = robot_.joints->read(now_ns, seen_.joints);
  static_cast<void>(robot_.base->read_base(seen_.base));  // how stale it is stands in the reading
  seen_.emergency_stop = robot_.emergency_stop->read_emergency_stop(now_ns);
  record_.bus_errors = robot_.buses->errors();
  const std::uint64_t errors = record_.bus_errors + malformed(seen_.joints, seen_.base);
  seen_.bus_errors = errors > bus_errors_;
  bus_errors_ = errors;
  reading_ = sensor_reading(1e-9 * static_cast<double>(now_ns - start_ns_), seen_.joints, seen_.base, now_ns);
  operator_ = mail_->commands.newest();
  seen_.heartbeat_expected = operator_.heartbeat_expected;
  seen_.heartbeat_age_s = 1e-9 * static_cast<double>(now_ns - operator_.heartbeat_ns);
}

/// A plan of an earlier session, made from another place, is none.
void TorqueCycle::look_at_plan(const control::Plan& plan) noexcept {
  const bool of_session = session_ != 0 && plan.nodes >= 2 && plan.start_time_s >= session_start_s_;
  const double now_s = reading_.time_s;
  seen_.has_plan = of_session && now_s <= plan.node[plan.nodes - 1].time_s;
  if (seen_.has_plan && supervisor_.output().rung == supervisor::Rung::gait) {  // back in step only
    seen_.has_plan = control::interpolate(plan, now_s).mode == gait_.contact();
  }
  seen_.plan_age_s = now_s - (of_session ? plan.start_time_s : session_start_s_);
  seen_.planned_speed_rad_s = planned_speed_rad_s(plan);
  const PlanningResult& result = record_.result = mail_->results.newest();
  const bool current = result.session == session_ && session_ != 0;
  seen_.failed_solves = current ? static_cast<int>(result.failures_in_a_row) : 0;
  seen_.solve_s = current ? 1e-9 * static_cast<double>(result.solve_ns) : 0.0;
}

/// Of the joints by what they follow: the plan, or the gait of the tick before. 0 before they must follow.
supervisor::Pose TorqueCycle::planned_speed_rad_s(const control::Plan& plan) const noexcept {
  supervisor::Pose speed_rad_s{};
  if (supervisor_.output().ramp < 1.0) return speed_rad_s;
  model::JointVector planned = model::JointVector::Zero();
  if (supervisor_.output().rung == supervisor::Rung::gait) {
    planned = gait_.velocity_rad_s();
  } else if (seen_.has_plan) {
    planned = control::interpolate(plan, reading_.time_s).state.tail<kJoints>();
  }
  std::copy_n(planned.data(), speed_rad_s.size(), speed_rad_s.begin());
  return speed_rad_s;
}

void TorqueCycle::estimate_state(const control::Plan& plan) noexcept {
  if (session_ == 0) {
    estimate_ = measured_state(reading_);
    return;
  }
  estimate_ = estimator_.update(reading_, contact(plan));
  seen_.controller_finite = seen_.controller_finite && estimate_.allFinite();
}

model::ContactMode TorqueCycle::contact(const control::Plan& plan) const noexcept {
  if (seen_.has_plan) return control::interpolate(plan, reading_.time_s).mode;
  return seen_.has_gait ? gait_.contact() : model::ContactMode{true, true};
}

/// The gait keeps in step with a robot that steps, whoever commands it.
void TorqueCycle::follow_gait(const control::Plan& plan) noexcept {
  const supervisor::SupervisorOutput& decision = supervisor_.output();
  const bool steps = decision.state == State::step || decision.state == State::walk;
  if (steps) {
    const bool followed = seen_.has_plan && seen_.plan_age_s < supervision_.stale_plan_s;
    gait_.tick(reading_, followed ? &plan : nullptr, estimate_, decision.gait.speed_m_s);
  } else {
    gait_.forget();
  }
  seen_.has_gait = steps && gait_.ready();
}

/// False for anything that is not a number.
bool TorqueCycle::near_standing_pose(double margin_rad) const noexcept {
  const auto near = [&](const model::JointVector& standing_rad) {
    return (reading_.joint_position_rad - standing_rad).cwiseAbs().maxCoeff() <= margin_rad;
  };
  return reading_.joint_position_rad.allFinite() && (near(standing_rad_[0]) || near(standing_rad_[1])) &&
         std::abs(reading_.base_pitch_rad - standing_pitch_rad_) <= margin_rad;
}

bool TorqueCycle::fit_to_stand() const noexcept {
  return near_standing_pose(supervision_.stand_pose_margin_rad) &&
         reading_.joint_velocity_rad_s.allFinite() &&
         std::abs(reading_.base_pitch_rate_rad_s) <= supervision_.stand_speed_rad_s &&
         reading_.joint_velocity_rad_s.cwiseAbs().maxCoeff() <= supervision_.stand_speed_rad_s;
}

void TorqueCycle::supervise() noexcept {
  supervisor::SupervisorInputs inputs;
  inputs.seen = seen_;
  inputs.seen.bring_up_failed = bring_up_.failed;
  inputs.request = operator_.request;
  inputs.bring_up_done = bring_up_.ready;
  inputs.shut_down = operator_.shut_down;
  inputs.fit_to_stand = fit_to_stand();
  inputs.in_stance = near_standing_pose(supervision_.stance_margin_rad);
  const supervisor::SupervisorOutput& decision = supervisor_.update(inputs);
  seen_.controller_finite = true;
  if (decision.clear_buses) robot_.buses->restore();
  if (decision.entered && decision.state == State::calibrate) {
    bring_up_ = {};
    robot_.drivers->begin();
  }
  if (decision.start_controller) {
    session_ = ++sessions_;
    session_start_s_ = reading_.time_s;
    seen_.has_plan = false;
    estimator_.reset(reading_, 0.0);
    estimate_ = estimator_.update(reading_, {true, true});
  }
  if (!supervisor::tracks(decision.state)) session_ = 0;
}

hal::JointCommands TorqueCycle::torque_law(const control::Plan& plan) noexcept {
  hal::JointCommands wanted{};
  for (std::size_t i = 0; i < hal::kJoints; ++i) {
    wanted[i].position_rad = seen_.joints[i].position_rad;
    wanted[i].torque_limit_Nm = limits_.torque_Nm[i];
  }
  if (supervisor_.output().rung == supervisor::Rung::gait) {
    for (std::size_t i = 0; i < hal::kJoints; ++i)
      wanted[i].torque_Nm = gait_.torque_Nm()[static_cast<int>(i)];
    return wanted;
  }
  if (!seen_.has_plan) return wanted;
  control::TorqueLoop& law =
      supervisor_.output().rung == supervisor::Rung::older_plan ? law_of_old_plan_ : law_;
  const control::TorqueCommand command = law.tick_with_state(reading_, estimate_, plan);
  if (command.status == control::TorqueStatus::damping_not_finite) seen_.controller_finite = false;
  for (std::size_t i = 0; i < hal::kJoints; ++i) wanted[i].torque_Nm = command.torque_Nm[static_cast<int>(i)];
  return wanted;
}

void TorqueCycle::act(supervisor::Action action) noexcept {
  switch (action) {
    case supervisor::Action::commands:
      seen_.write_status = robot_.joints->write(commands_);
      break;
    case supervisor::Action::disable:
      seen_.write_status = robot_.joints->disable();
      break;
    case supervisor::Action::silent:
      seen_.write_status = JointBusStatus::ok;
      if (supervisor_.output().state == State::calibrate && !bring_up_.failed) bring_up();
      break;
  }
}

void TorqueCycle::bring_up() noexcept {
  bring_up_ = robot_.drivers->step(seen_.time_ns);
  if (!bring_up_.failed) return;
  push({.kind = Event::Kind::bring_up_failed,
        .joint = static_cast<std::uint8_t>(bring_up_.joint),
        .failure = bring_up_.failure,
        .driver_fault = bring_up_.fault});
}

void TorqueCycle::ask_for_plan() noexcept {
  PlanningRequest& request = mail_->requests.writer();
  request.tick = ticks_;
  request.time_s = reading_.time_s;
  request.session = session_;
  request.state = estimate_;
  request.command = supervisor_.output().gait;
  mail_->requests.publish();
}

void TorqueCycle::record(const TickTiming& timing, const hal::JointCommands& wanted,
                         supervisor::Action action, const control::Plan& plan) noexcept {
  const supervisor::SupervisorOutput& decision = supervisor_.output();
  record_.tick = static_cast<std::uint64_t>(ticks_);
  record_.time_ns = timing.now_ns;
  record_.joints = seen_.joints;
  record_.base = seen_.base;
  record_.read_status = seen_.read_status;
  record_.write_status = seen_.write_status;
  record_.emergency_stop = seen_.emergency_stop;
  record_.bring_up = bring_up_;
  record_.command = operator_;
  record_.visible_plan = plan.sequence;
  std::copy_n(estimate_.data(), record_.estimated_state.size(), record_.estimated_state.begin());
  record_.wanted = wanted;
  record_.sent = commands_;
  record_.action = action;
  record_.state = decision.state;
  record_.rung = decision.rung;
  record_.reaction = decision.reaction;
  record_.present = decision.present;
  record_.latched = decision.latched;
  record_.ramp = decision.ramp;
  record_.plan_sequence = seen_.has_plan ? plan.sequence : -1;
  record_.plan_age_s = seen_.plan_age_s;
  record_.standing = session_;
  record_.gait = decision.gait;
  record_.wakeup_ns = timing.late_ns;
  record_.execution_ns = timing.execution_ns;
  record_.round_trip_ns = timing.round_trip_ns;
  mail_->telemetry.push(record_);
  if (diagnostics::TickRecord* kept = mail_->black_box.claim()) {
    *kept = record_;
    mail_->black_box.commit(decision.reaction >= supervisor::Reaction::hold);
  }
}

void TorqueCycle::push(const Event& event) noexcept {
  Event timed = event;
  timed.time_s = reading_.time_s;
  mail_->events.push(timed);
}

void TorqueCycle::report_events() noexcept {
  const supervisor::SupervisorOutput& decision = supervisor_.output();
  for (const supervisor::FaultRow& row : supervisor::kFaultTable) {
    if (decision.raised.has(row.fault)) push({.kind = Event::Kind::fault, .fault = row.fault});
  }
  if (decision.entered || ticks_ == 0) push({.kind = Event::Kind::state, .state = decision.state});
  const bool stood_up = before_ == State::stand && decision.state == State::ready;
  if (decision.entered && stood_up) push({.kind = Event::Kind::lost_stance});
  before_ = decision.state;
  const bool waits = decision.state == State::ready && !decision.entered &&
                     operator_.request.kind == supervisor::RequestKind::stand;
  if (waits && !waiting_told_) push({.kind = Event::Kind::waits_for_pose});
  waiting_told_ = waits;
}

}  // namespace stilt::controller
