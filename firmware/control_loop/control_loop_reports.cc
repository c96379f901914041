#include <algorithm>
#include <limits>

#include "firmware/control_loop/control_loop.h"

// What a tick leaves for telemetry, black box and operator.
namespace stilt::control_loop {

using supervisor::FallbackLevel;
using supervisor::State;

void ControlLoop::record(const TickTiming& timing, const OperatorCommand& command,
                         const PlanningResult& result, const PlanView& plan,
                         const model::StateVector& estimate, const hal::JointCommands& wanted,
                         supervisor::Action action) noexcept {
  const supervisor::SupervisorOutput& decision = supervisor_.output();
  record_.tick = static_cast<std::uint64_t>(ticks_);
  record_.time_ns = timing.now_ns;
  record_.joints = readings_.joints;
  record_.base = readings_.base;
  record_.read_status = readings_.status;
  record_.write_status = write_status_;
  record_.emergency_stop = readings_.emergency_stop;
  record_.bus_errors = readings_.bus_errors;
  record_.bring_up = bring_up_;
  record_.command = command;
  record_.tuning = tuning_;
  record_.result = result;
  record_.visible_plan = plan.sequence;
  std::copy_n(estimate.data(), record_.estimated_state.size(), record_.estimated_state.begin());
  record_.wanted = wanted;
  const PlannedJoints planned = planned_joints(plan);
  for (std::size_t i = 0; i < hal::kJoints; ++i) {
    record_.wanted[i].position_rad = planned.position_rad[i];
    record_.wanted[i].velocity_rad_s = planned.speed_rad_s[i];
  }
  record_.sent = commands_;
  record_.action = action;
  record_.state = decision.state;
  record_.level = decision.level;
  record_.reaction = decision.reaction;
  record_.present = decision.present;
  record_.latched = decision.latched;
  record_.ramp = decision.ramp;
  record_.plan_sequence = decision.level <= FallbackLevel::plan_feedback ? plan.sequence : -1;
  record_.plan_age_s = episode_ != 0 ? plan.age_s : std::numeric_limits<double>::quiet_NaN();
  record_.stance_episode = episode_;
  record_.gait = decision.gait;
  record_.wakeup_latency_ns = timing.wakeup_latency_ns;
  record_.execution_ns = timing.execution_ns;
  record_.bus_round_trip_ns = timing.bus_round_trip_ns;
  mail_->telemetry.push(record_);
  const bool harder = decision.reaction >= supervisor::Reaction::hold && decision.reaction > kept_reaction_;
  if (TickRecord* kept = mail_->black_box.claim()) {
    *kept = record_;
    mail_->black_box.commit(harder);
    kept_reaction_ = decision.reaction;
  }
}

void ControlLoop::push(const Event& event) noexcept {
  Event timed = event;
  timed.time_s = time_s_;
  control_loop::push(mail_->events, timed);
}

void ControlLoop::report_events(const supervisor::Observation& seen) noexcept {
  const supervisor::SupervisorOutput& decision = supervisor_.output();
  for (const supervisor::FaultRow& row : supervisor::kFaultTable) {
    if (decision.ended.has(row.fault)) push({.kind = Event::Kind::fault_over, .fault = row.fault});
    if (!decision.raised.has(row.fault)) continue;
    supervisor::FaultDetail found = supervisor::detail(row.fault, seen, limits_, supervision_);
    if (row.fault == supervisor::Fault::bring_up_failed) {
      found = {.joint = static_cast<int>(bring_up_.joint),
               .driver_fault = bring_up_.fault,
               .fault_code = bring_up_.fault_code};
    }
    push({.kind = Event::Kind::fault, .fault = row.fault, .found = found});
  }
  if (decision.entered || ticks_ == 0) push({.kind = Event::Kind::state, .state = decision.state});
  const bool gave_up = before_ == State::stand && decision.state == State::ready;
  if (decision.entered && gave_up && !stance_miss_.none()) {  // else it was stopped while it stood up
    push({.kind = Event::Kind::lost_stance, .pose = stance_miss_});
  }
  before_ = decision.state;
  if (decision.state != State::off) last_state_ = decision.state;
  const bool waits = decision.state == State::ready && decision.waits_to_stand;
  if (waits && !waiting_reported_) push({.kind = Event::Kind::waits_for_pose, .pose = stand_miss_});
  if (decision.stand_void) push({.kind = Event::Kind::stopped_waiting, .pose = stand_miss_});
  waiting_reported_ = waits;
}

}  // namespace stilt::control_loop
