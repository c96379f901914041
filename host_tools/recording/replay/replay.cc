#include "host_tools/recording/replay/replay.h"

#include <utility>

#include "firmware/control_loop/plan_checksum.h"

// What a record holds, and why a replay starts at tick 0: docs/decisions/0010-records.md
namespace stilt::replay {

Replay::Replay(std::vector<control_loop::CycleRecord> cycles, TuningsByNumber tunings)
    : cycles_(std::move(cycles)),
      tunings_(std::move(tunings)),
      mail_(std::make_unique<control_loop::Mailboxes>()),
      loop_(std::make_unique<control_loop::ControlLoop>()),
      planner_(std::make_unique<control_loop::PlannerTask>()) {
  loop_->attach(robot_, *mail_);
}

bool Replay::fail(const std::string& problem) {
  outcome_.problem = problem;
  ended_ = true;
  return false;
}

bool Replay::differ(const Difference& difference) {
  outcome_.difference = difference;
  ended_ = true;
  return false;
}

bool Replay::run(const control_loop::TickRecord& recorded) {
  if (ended_) return false;
  if (recorded.tick != next_tick_) {
    const std::string missing =
        next_tick_ + 1 == recorded.tick
            ? "tick " + std::to_string(next_tick_) + " is"
            : "ticks " + std::to_string(next_tick_) + " to " + std::to_string(recorded.tick - 1) + " are";
    return fail(missing +
                " missing in the record; a replay needs every tick from tick 0 on, as the controller " +
                "remembers: start stilt record before stiltd, or soon after");
  }
  if (!hand_in(recorded)) return false;
  robot_.set(recorded);
  loop_->tick(
      {recorded.time_ns, recorded.wakeup_latency_ns, recorded.execution_ns, recorded.bus_round_trip_ns});
  const control_loop::TickRecord replayed = *mail_->telemetry.front();
  mail_->telemetry.pop();
  while (mail_->events.front() != nullptr) mail_->events.pop();
  if (const auto difference = compare(recorded, replayed)) return differ(*difference);
  ++outcome_.ticks;
  ++next_tick_;
  while (next_cycle_ < cycles_.size() &&
         cycles_[next_cycle_].tick <= static_cast<std::int64_t>(recorded.tick)) {
    if (!run_cycle(cycles_[next_cycle_++])) return false;
  }
  return true;
}

/// Writes all recorded inputs to the mailboxes of the control loop.
bool Replay::hand_in(const control_loop::TickRecord& recorded) {
  mail_->commands.writer() = recorded.command;
  mail_->commands.publish();
  mail_->results.writer() = recorded.result;
  mail_->results.publish();
  if (recorded.tuning != torque_tuning_) {
    const auto tunings = tunings_(recorded.tuning);
    if (!tunings)
      return fail("tuning " + std::to_string(recorded.tuning) + " of tick " + std::to_string(recorded.tick) +
                  ' ' + tunings.error());
    mail_->torque_tunings.writer() = tunings->torque;
    mail_->torque_tunings.publish();
    torque_tuning_ = recorded.tuning;
  }
  return hand_in_plan(recorded);
}

bool Replay::hand_in_plan(const control_loop::TickRecord& recorded) {
  if (recorded.visible_plan == visible_plan_) return true;
  const auto plan = plans_.find(recorded.visible_plan);
  if (plan == plans_.end()) {
    return fail("plan " + std::to_string(recorded.visible_plan) + ", there in tick " +
                std::to_string(recorded.tick) + ", is missing in the record");
  }
  mail_->plans.writer() = *plan->second;
  mail_->plans.publish();
  visible_plan_ = recorded.visible_plan;
  plans_.erase(plans_.begin(), std::next(plan));
  return true;
}

/// Solves as the planner did, with the request of the last tick.
bool Replay::run_cycle(const control_loop::CycleRecord& recorded) {
  if (recorded.cycle != solves_ + 1) {
    return fail("solve " + std::to_string(solves_ + 1) +
                " of the planner is missing in the record, which has " + std::to_string(recorded.cycle) +
                " next");
  }
  const control_loop::PlanningRequest& request = mail_->requests.newest();
  if (recorded.tick != request.tick) {
    return fail("solve " + std::to_string(recorded.cycle) + " of the planner belongs to tick " +
                std::to_string(recorded.tick) + ", out of order in the record");
  }
  if (recorded.tuning != planner_->tuning()) {
    const auto tunings = tunings_(recorded.tuning);
    if (!tunings)
      return fail("tuning " + std::to_string(recorded.tuning) + " of solve " +
                  std::to_string(recorded.cycle) + ' ' + tunings.error());
    planner_->tune(tunings->planner);
  }
  auto plan = std::make_unique<control::Plan>();
  const bool fresh = planner_->cycle(request, *plan);
  ++solves_;
  control_loop::CycleRecord replayed = recorded;
  replayed.cycle = planner_->result().cycles;
  replayed.time_s = request.time_s;
  replayed.stance_episode = request.stance_episode;
  replayed.failures = planner_->result().failures_in_a_row;
  replayed.plan_sequence = fresh ? plan->sequence : -1;
  replayed.nodes = fresh ? plan->nodes : 0;
  replayed.checksum = fresh ? control_loop::plan_checksum(*plan) : 0;
  replayed.report = planner_->report();
  if (const auto difference = compare(recorded, replayed)) return differ(*difference);
  ++outcome_.cycles;
  if (fresh) plans_[plan->sequence] = std::move(plan);
  return true;
}

}  // namespace stilt::replay
