#include "host_tools/simulation/closed_loop/simulated_controller.h"

#include <utility>

namespace stilt::simulation {
namespace {

supervisor::RequestKind request_for(gait::GaitKind kind) {
  switch (kind) {
    case gait::GaitKind::stand:
      return supervisor::RequestKind::stand;
    case gait::GaitKind::step:
      return supervisor::RequestKind::step;
    case gait::GaitKind::walk:
      break;
  }
  return supervisor::RequestKind::walk;
}

}  // namespace

std::size_t SimulatedController::bytes() {
  return sizeof(control_loop::PlannerTask) + sizeof(control_loop::ControlLoop) +
         sizeof(control_loop::Mailboxes::plans);
}

control::ConfigureStatus SimulatedController::configure(ControllerSetup setup) {
  setup_ = std::move(setup);
  schedule_ = control_loop::PlannerSchedule(setup_.parameters.timing);
  const model::RobotModel* planned = setup_.planning_model != nullptr ? setup_.planning_model : setup_.robot;
  model::InstructionSet& instruction_set = setup_.parameters.sqp.instruction_set;
  if (instruction_set == model::InstructionSet::automatic) {
    instruction_set = dispatch::instruction_set_of_build();
  }
  const control::ConfigureStatus status = planner_->configure(*planned, setup_.parameters);
  if (setup_.reference_gaits != nullptr) planner_->follow(*setup_.reference_gaits);
  return status;
}

std::int64_t SimulatedController::begin(hal::Robot& robot, const gait::GaitCommand& command,
                                        const model::StateVector* known_state) {
  mail_ = std::make_unique<control_loop::Mailboxes>();
  loop_ = std::make_unique<control_loop::ControlLoop>();
  loop_->configure(*setup_.robot, setup_.parameters, setup_.supervision);
  if (setup_.fallback_gaits != nullptr) {
    loop_->track_without_plan(*setup_.robot, setup_.parameters, *setup_.fallback_gaits);
  }
  loop_->attach(robot, *mail_);
  schedule_ = control_loop::PlannerSchedule(setup_.parameters.timing);
  planner_->restart();
  command_ = {};
  loop_->begin_standing(schedule_.timing().tick_ns, command, known_state);
  return schedule_.begin(*planner_, *mail_, clock_);
}

/// Another kind of gait makes another request.
void SimulatedController::publish(const gait::GaitCommand& command) {
  const supervisor::RequestKind kind = request_for(command.kind);
  if (kind != command_.request.kind) command_.request = {kind, command_.request.number + 1};
  command_.request.speed_m_s = command.speed_m_s;
  mail_->commands.writer() = command_;
  mail_->commands.publish();
}

const control_loop::TickRecord& SimulatedController::tick(long long tick, const gait::GaitCommand& command,
                                                          const model::StateVector* known_state) {
  publish(command);
  schedule_.publish_due(tick, *planner_, *mail_);
  loop_->tick({.now_ns = (1 + tick) * schedule_.timing().tick_ns}, known_state);  // a time of 0 means none
  record_ = *mail_->telemetry.front();
  mail_->telemetry.pop();
  while (mail_->events.front() != nullptr) mail_->events.pop();
  return record_;
}

std::optional<std::int64_t> SimulatedController::plan(long long tick) {
  const auto duration_ns = schedule_.plan(tick, *planner_, *mail_, clock_);
  while (mail_->cycles.front() != nullptr) mail_->cycles.pop();
  return duration_ns;
}

}  // namespace stilt::simulation
