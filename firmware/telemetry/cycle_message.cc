#include "firmware/telemetry/cycle_message.h"

namespace stilt::telemetry {
namespace {

/// Calls visit(number of the message, value of the record) for every field that both have.
template <class Message, class Record, class Visit>
void for_each_field(Message& message, Record& record, Visit&& visit) {
  visit(message.cycle, record.cycle);
  visit(message.tick, record.tick);
  visit(message.time_s, record.time_s);
  visit(message.stance_episode, record.stance_episode);
  visit(message.plan_sequence, record.plan_sequence);
  visit(message.failures, record.failures);
  visit(message.tuning, record.tuning);
  visit(message.nodes, record.nodes);
  visit(message.checksum, record.checksum);
  visit(message.solve_ns, record.solve_ns);
  visit(message.status, record.report.status);
  visit(message.iterations, record.report.iterations);
  visit(message.cost, record.report.cost);
  visit(message.dynamics_defect_max, record.report.dynamics_defect_max);
  visit(message.equality_violation_max, record.report.equality_violation_max);
  visit(message.line_search_step, record.report.line_search_step);
  visit(message.step_component_max, record.report.step_component_max);
  visit(message.friction_cone_violation_max_N, record.report.violations.friction_cone_violation_max_N);
  visit(message.pulling_force_max_N, record.report.violations.pulling_force_max_N);
  visit(message.impulse_cone_violation_max_Ns, record.report.violations.impulse_cone_violation_max_Ns);
  visit(message.torque_violation_max_Nm, record.report.violations.torque_violation_max_Nm);
  visit(message.position_violation_max_rad, record.report.violations.position_violation_max_rad);
  visit(message.velocity_violation_max_rad_s, record.report.violations.velocity_violation_max_rad_s);
}

/// Copies where only the types may differ.
constexpr auto convert = []<class To>(const auto& from, To& to) { to = static_cast<To>(from); };

}  // namespace

PlannerCycle cycle_message(const control_loop::CycleRecord& record) noexcept {
  PlannerCycle message{};
  for_each_field(message, record, [](auto& number, const auto& value) { convert(value, number); });
  return message;
}

control_loop::CycleRecord cycle_record(const PlannerCycle& message) noexcept {
  control_loop::CycleRecord record;
  for_each_field(message, record, [](const auto& number, auto& value) { convert(number, value); });
  return record;
}

}  // namespace stilt::telemetry
