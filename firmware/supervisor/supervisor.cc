#include "firmware/supervisor/supervisor.h"

#include <algorithm>
#include <cmath>

#include "firmware/supervisor/safe_commands.h"

// States, faults and levels: docs/decisions/0006-supervision-and-real-time-proofs.md; stops, and absences
// that end: docs/decisions/0019-stops-and-no-commander.md
namespace stilt::supervisor {
namespace {

constexpr FaultSet kLatching = of_severity(Severity::latched);

/// Share of the torque law from which a robot that stands up carries itself.
constexpr double kCarries = 0.5;
/// Longest wait for rest, before a robot that shall sit does so in motion.
constexpr double kRestWait_s = 5.0;

/// Causes that show only in what drivers and sensors send.
constexpr FaultSet kOfReplies = [] {
  FaultSet set;
  for (const Fault fault : {Fault::missed_replies, Fault::lost_replies, Fault::stale_torso_sensor,
                            Fault::driver_not_enabled, Fault::driver_fault}) {
    set.add(fault);
  }
  return set;
}();

/// Those that need a moment after drivers came up. Silence does not: bring-up ends with drivers that answer.
constexpr FaultSet kUnsettled = [] {
  FaultSet set;
  for (const Fault fault : {Fault::stale_torso_sensor, Fault::driver_not_enabled, Fault::driver_fault}) {
    set.add(fault);
  }
  return set;
}();

/// The state in which a request is met.
State goal(RequestKind kind) noexcept {
  switch (kind) {
    case RequestKind::calibrate:
      return State::calibrate;
    case RequestKind::stand:
      return State::stand;
    case RequestKind::step:
      return State::step;
    case RequestKind::walk:
      return State::walk;
    case RequestKind::sit:
      return State::sit;
    case RequestKind::reset:
      return State::idle;
    case RequestKind::off:
    case RequestKind::cut:
    case RequestKind::none:
      return State::off;
  }
  return State::off;
}

/// The joints are under position control of their drivers.
bool holds(FallbackLevel level) noexcept {
  return level == FallbackLevel::hold || level == FallbackLevel::sit;
}

gait::GaitKind gait_kind(State state) noexcept {
  if (state == State::walk) return gait::GaitKind::walk;
  return state == State::step ? gait::GaitKind::step : gait::GaitKind::stand;
}

}  // namespace

void Supervisor::configure(const JointLimits& limits, const SupervisorParameters& parameters) noexcept {
  *this = Supervisor();
  limits_ = limits;
  parameters_ = parameters;
}

void Supervisor::begin_standing(std::int64_t now_ns) noexcept {
  const double longest_s = std::max({parameters_.stand_ramp_s, parameters_.slow_down_s, parameters_.settle_s,
                                     parameters_.stale_plan_s, parameters_.hold_ramp_s});
  entered_ns_ = driven_ns_ = tracking_ns_ = level_ns_ = hold_ns_ =
      now_ns - static_cast<std::int64_t>(1e9 * (1.0 + longest_s));
  started_ = true;
  drivers_are_ = DriversAre::brought_up;
  output_.state = State::stand;
  output_.level = FallbackLevel::plan;
  output_.ramp = 1.0;
}

double Supervisor::since_s(std::int64_t time_ns) const noexcept {
  return 1e-9 * static_cast<double>(now_ns_ - time_ns);
}

const SupervisorOutput& Supervisor::update(const SupervisorInputs& inputs) noexcept {
  now_ns_ = inputs.seen.time_ns;
  if (!started_) entered_ns_ = level_ns_ = now_ns_;
  started_ = true;
  measured_ = inputs.seen.joints;
  fit_to_stand_ = inputs.fit_to_stand;
  if (inputs.at_rest || output_.state != State::stand) rest_ns_ = now_ns_;
  can_step_ = inputs.seen.followable.plan != PlanUse::none || inputs.seen.followable.gait;
  pose_rad_ = measured_pose_rad(measured_, pose_rad_);
  output_.entered = output_.start_controller = false;
  shutting_down_ = inputs.shut_down;
  find_faults(inputs);
  void_request_when_met(inputs.request);
  void_request_after_faults(inputs.request);
  watch_reset_window(inputs.request);
  give_up_waiting_to_stand(inputs.request);
  refuse_steps(inputs.request);
  move(inputs);
  choose(inputs);
  return output_;
}

FaultSet Supervisor::looked_for(const Observation& seen) const noexcept {
  FaultSet set;
  if (output_.state == State::boot || output_.state == State::off) return set;
  set = watched(Watch::always);
  if (output_.state == State::calibrate) set = set | watched(Watch::bring_up);
  if (drives(output_.state) && drivers_are_ == DriversAre::brought_up) set = set | watched(Watch::driven);
  if (has_torque(output_.state)) set = set | watched(Watch::torque);
  if (tracks(output_.state)) set = set | watched(Watch::tracking);
  const bool may_be_idle = output_.level == FallbackLevel::off || resetting_;
  if (may_be_idle) set = set - kEndedByBringUp;
  if (1e-9 * static_cast<double>(seen.time_ns - driven_ns_) < parameters_.settle_s) set = set - kUnsettled;
  if (1e-9 * static_cast<double>(seen.time_ns - tracking_ns_) < parameters_.stale_plan_s) {
    FaultSet no_plan_yet;
    no_plan_yet.add(Fault::stale_plan);
    set = set - no_plan_yet;
  }
  return set;
}

void Supervisor::find_faults(const SupervisorInputs& inputs) noexcept {
  FaultSet found = detect(inputs.seen, limits_, parameters_);
  heartbeat_lost_ = found.has(Fault::heartbeat_lost);
  found.add_if(command_not_finite_, Fault::not_finite);
  command_not_finite_ = false;
  const FaultSet looked = looked_for(inputs.seen);
  const FaultSet present = found & looked;
  const bool stopped_now = present.has(Fault::emergency_stop) && !output_.latched.has(Fault::emergency_stop);
  if (stopped_now) stopped_ns_ = now_ns_;
  output_.raised = present - output_.present;
  output_.ended = (output_.present - present) & looked;
  output_.present = present;
  output_.latched = output_.latched | (present & kLatching);
  output_.reaction = std::max(reaction(present), reaction(output_.latched));
}

/// A request for the state that the robot is in is met. Nothing gets there once more by itself after it left.
void Supervisor::void_request_when_met(const Request& request) noexcept {
  if (output_.state == goal(request.kind)) void_number_ = std::max(void_number_, request.number);
}

/// A reset that brings links back also brings back what their drivers have kept: it goes on. Without its host
/// the robot still goes where it rests: to sit and off, which take their time, and stay asked for. Once the
/// joints are damped, no fault keeps the motors from going off.
void Supervisor::void_request_after_faults(const Request& request) noexcept {
  const FaultSet unforeseen = resetting_ ? output_.raised - kOfReplies : output_.raised;
  const bool goes_off = damps(output_.state) && request.kind == RequestKind::off;
  const bool new_latched = !goes_off && !(unforeseen & kLatching).empty();
  const bool alone = output_.present.has(Fault::heartbeat_lost) && !leads_to_rest(request.kind);
  if (new_latched || alone) void_number_ = std::max(void_number_, request.number);
  if (output_.present.has(Fault::heartbeat_lost)) {
    slowing_ = true;
    slow_number_ = request.number;
  }
  const bool slows = output_.state == State::step || output_.state == State::walk;
  if (!slows || request.number > slow_number_) slowing_ = false;
}

/// A reset begins when the joints were damped. One that finds a cause still present when its window ends is
/// void: nothing resets itself later.
void Supervisor::watch_reset_window(const Request& request) noexcept {
  const bool asked = output_.state == State::fault && was_damped() && requested(RequestKind::reset, request);
  if (asked && !resetting_) reset_ns_ = now_ns_;
  resetting_ = asked;
  if (asked && since_s(reset_ns_) > parameters_.reset_window_s) {
    void_number_ = request.number;
    resetting_ = false;
  }
  output_.clear_buses = resetting_;
}

/// A step needs more torque than may be used: what cannot be met does not wait for another limit.
void Supervisor::refuse_steps(const Request& request) noexcept {
  const bool steps = request.kind == RequestKind::step || request.kind == RequestKind::walk;
  if (steps && !may_walk(parameters_)) void_number_ = std::max(void_number_, request.number);
}

/// Nothing stands up by itself minutes after it was asked for, nor after its commander fell silent.
void Supervisor::give_up_waiting_to_stand(const Request& request) noexcept {
  const bool waits = output_.state == State::ready && requested(RequestKind::stand, request);
  if (!waits || !output_.waits_to_stand) stand_asked_ns_ = now_ns_;
  const bool too_long = since_s(stand_asked_ns_) > parameters_.stand_wait_s;
  output_.stand_void = waits && (too_long || heartbeat_lost_);
  if (output_.stand_void) void_number_ = std::max(void_number_, request.number);
  output_.waits_to_stand = waits && !output_.stand_void;
}

bool Supervisor::requested(RequestKind kind, const Request& request) const noexcept {
  const bool steps = kind == RequestKind::step || kind == RequestKind::walk;
  if (steps && (shutting_down_ || !output_.latched.empty())) return false;  // on its way to sit
  if (kind == RequestKind::stand && shutting_down_) return false;           // nor to stand up again
  return request.kind == kind && request.number > void_number_;
}

bool Supervisor::applies(Condition condition, const SupervisorInputs& inputs) const noexcept {
  const Request& request = inputs.request;
  switch (condition) {
    case Condition::emergency_stop_known:
      return inputs.seen.emergency_stop != hal::EmergencyStopState::unknown ||
             since_s(entered_ns_) >= parameters_.emergency_stop_wait_s;
    case Condition::bring_up_done:
      return inputs.bring_up_done;
    case Condition::sit_done:
      return since_s(entered_ns_) >= parameters_.sit_s;
    case Condition::damp_fault:
      return output_.reaction >= Reaction::damp;
    case Condition::sit_fault:
      return output_.reaction == Reaction::sit;
    case Condition::slow_fault:
      return output_.present.has(Fault::heartbeat_lost) || slowing_;
    case Condition::request_calibrate:
      return requested(RequestKind::calibrate, request);
    case Condition::request_stand:
      return requested(RequestKind::stand, request);
    case Condition::request_step:
      return requested(RequestKind::step, request);
    case Condition::request_walk:
      return requested(RequestKind::walk, request);
    case Condition::request_sit:
      return requested(RequestKind::sit, request);
    case Condition::request_reset:
      return requested(RequestKind::reset, request);
    case Condition::request_off:
      return requested(RequestKind::off, request);
    case Condition::request_cut:
      return request.kind == RequestKind::cut;  // never void
    case Condition::shut_down:
      return inputs.shut_down;
    case Condition::lost_stance:
      return !inputs.in_stance;
  }
  return false;
}

bool Supervisor::passes(Guard guard) const noexcept {
  switch (guard) {
    case Guard::always:
      return true;
    case Guard::ramp_done:
      return since_s(tracking_ns_) >= parameters_.stand_ramp_s;
    case Guard::ramping:
      return since_s(tracking_ns_) < parameters_.stand_ramp_s;
    case Guard::rising:
      return ramp() < kCarries;
    case Guard::cannot_step:
      return !can_step_;
    case Guard::slowed_down:
      return since_s(entered_ns_) >= parameters_.slow_down_s;
    case Guard::at_rest:
      return since_s(entered_ns_) >= parameters_.slow_down_s &&
             (rest_ns_ == now_ns_ || since_s(rest_ns_) >= kRestWait_s);
    case Guard::damped:
      return was_damped();
    case Guard::causes_gone:
      return resetting_ && now_ns_ > reset_ns_ && (output_.present & kLatching).empty();
    case Guard::none_latched:
      return output_.latched.empty();
    case Guard::fit_to_stand:
      return output_.latched.empty() && fit_to_stand_;
    case Guard::fault_latched:
      return !output_.latched.empty();
  }
  return false;
}

/// Share of the torque law while it is in command.
double Supervisor::ramp() const noexcept {
  return parameters_.stand_ramp_s > 0 ? std::clamp(since_s(tracking_ns_) / parameters_.stand_ramp_s, 0.0, 1.0)
                                      : 1.0;
}

void Supervisor::move(const SupervisorInputs& inputs) noexcept {
  for (const Transition& transition : kTransitions) {
    if (transition.from == output_.state && applies(transition.condition, inputs) &&
        passes(transition.guard)) {
      enter(transition.to);
      return;
    }
  }
}

void Supervisor::enter(State state) noexcept {
  const State before = output_.state;
  if (before == State::fault && state == State::idle) {
    output_.latched = FaultSet();
    output_.reaction = reaction(output_.present);
    output_.clear_buses = resetting_ = false;
  }
  if (damps(state) && !damps(before)) damped_ns_ = now_ns_;
  if (drives(state) && !drives(before)) driven_ns_ = now_ns_;
  if (state == State::idle) {
    was_up_ = was_up_ || drivers_are_ != DriversAre::left_alone;
    drivers_are_ = DriversAre::left_alone;
  }
  if (state == State::calibrate) drivers_are_ = DriversAre::being_brought_up;
  if (state == State::ready) drivers_are_ = DriversAre::brought_up;
  if (tracks(state) && !tracks(before)) {
    tracking_ns_ = now_ns_;
    stand_pose_rad_ = pose_rad_;
    followed_ = {};
    output_.start_controller = true;
  }
  output_.state = state;
  output_.entered = true;
  entered_ns_ = now_ns_;
}

/// Faults that ask to sit change the state; until the robot sits, the level is that of the other faults.
Reaction Supervisor::reaction_of_level() const noexcept {
  if (output_.reaction != Reaction::sit || !tracks(output_.state)) return output_.reaction;
  Reaction hardest = Reaction::none;
  for (const FaultRow& fault : kFaultTable) {
    if (output_.present.has(fault.fault) && fault.reaction != Reaction::sit) {
      hardest = std::max(hardest, fault.reaction);
    }
  }
  return hardest;
}

/// In ready and fault: a robot that sat or fell is down, and its joints may go limp.
bool Supervisor::was_damped() const noexcept {
  return output_.level == FallbackLevel::off || since_s(damped_ns_) >= parameters_.damped_before_off_s;
}

/// After an emergency stop the robot settles damped; then the motors need no power until a reset with the
/// stop released.
bool Supervisor::stopped_for_good() const noexcept {
  const bool resets = resetting_ && !output_.present.has(Fault::emergency_stop);
  return output_.state == State::fault && output_.latched.has(Fault::emergency_stop) && !resets &&
         since_s(std::max(stopped_ns_, entered_ns_)) >= parameters_.damped_before_off_s;
}

void Supervisor::choose(const SupervisorInputs& inputs) noexcept {
  const bool never_up = output_.state == State::fault && drivers_are_ != DriversAre::brought_up;
  const FallbackLevel level = never_up || stopped_for_good()
                                  ? FallbackLevel::off
                                  : select_level(output_.state, reaction_of_level(), inputs.seen.followable);
  if (level != output_.level) {
    if (!holds(output_.level)) hold_ns_ = now_ns_;
    level_ns_ = now_ns_;
    level_pose_rad_ = pose_rad_;
  }
  output_.level = level;
  output_.ramp = tracks(output_.state) ? ramp() : 0.0;
  output_.gait.kind = gait_kind(output_.state);
  const bool walks = output_.state == State::walk && inputs.request.kind == RequestKind::walk;
  output_.gait.speed_m_s = walks && std::isfinite(inputs.request.speed_m_s) ? inputs.request.speed_m_s : 0;
}

}  // namespace stilt::supervisor
