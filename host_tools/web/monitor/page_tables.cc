#include "host_tools/web/monitor/page_tables.h"

#include <limits>
#include <string>
#include <vector>

#include "firmware/control_loop/tick_fields.h"
#include "firmware/supervisor/signal_monitor.h"
#include "host_tools/web/monitor/table_message.h"

namespace stilt::monitor {
namespace {

using control_loop::TickGroup;
using control_loop::TickRecord;
using TickColumns = std::vector<Column<TickSample>>;

/// Adds the fields of a group that have a name on the page.
template <TickGroup kGroup>
void add_fields(TickColumns& columns) {
  control_loop::for_each_field_of<kGroup>([&](const auto& field) {
    if (field.names.page.empty()) return;
    const double factor = control_loop::unit_factor(field.wire, field.names.page);
    columns.push_back({std::string(field.names.page),
                       [=](const TickSample& tick, std::size_t index) {
                         return factor * static_cast<double>(field.at(tick.record, index));
                       },
                       field.count()});
  });
}

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Time without a reply after which a joint's last reading is no longer shown as what is.
constexpr double kOldReading_s = 0.1;

bool is_old(const TickSample& tick, std::size_t joint) {
  return tick.record.joints[joint].missed_replies > kOldReading_s * tick.tick_rate_hz;
}

/// NaN where it is not known: the place of the hip, unless the robot is on its feet; joints that do not
/// answer.
double estimated_state(const TickSample& tick, std::size_t index) {
  constexpr std::size_t kAngle = model::kFirstAngle, kJoint = kAngle + 1;
  const std::size_t position = index % model::kPositions;
  const bool off_its_feet = position < kAngle && tick.record.stance_episode == 0;
  const bool silent = position >= kJoint && is_old(tick, position - kJoint);
  return off_its_feet || silent ? kUnknown : tick.record.estimated_state[index];
}

double measured_torque_Nm(const TickSample& tick, std::size_t joint) {
  return is_old(tick, joint) ? kUnknown : tick.record.joints[joint].torque_Nm;
}

/// The pose that a driver holds by its own gain; without one where plan or gait has the joint. NaN when no
/// commands were sent.
double wanted_position_rad(const TickSample& tick, std::size_t joint) {
  if (tick.record.action != supervisor::Action::commands) return kUnknown;
  const hal::JointCommand& sent = tick.record.sent[joint];
  return sent.kp_Nm_rad > 0.0 ? sent.position_rad : tick.record.wanted[joint].position_rad;
}

/// 0 when no commands were sent.
double asked_torque_Nm(const TickSample& tick, std::size_t joint) {
  if (tick.record.action != supervisor::Action::commands) return 0.0;
  return supervisor::asked_torque_Nm(tick.record.sent, tick.record.joints)[joint];
}

TickColumns make_tick_columns() {
  TickColumns columns;
  columns.push_back({"estimated_state", estimated_state, model::kStates});
  columns.push_back({"wanted_position_rad", wanted_position_rad, hal::kJoints});
  columns.push_back({"asked_torque_Nm", asked_torque_Nm, hal::kJoints});
  columns.push_back({"measured_torque_Nm", measured_torque_Nm, hal::kJoints});
  add_fields<TickGroup::ramp>(columns);
  add_fields<TickGroup::plan>(columns);
  add_fields<TickGroup::timing>(columns);
  add_fields<TickGroup::decision>(columns);
  add_fields<TickGroup::gait>(columns);
  return columns;
}

const TickColumns& tick_columns() {
  static const TickColumns columns = make_tick_columns();
  return columns;
}

const std::vector<Column<PlannerSample>> kPlannerColumns = {
    {"status", [](const PlannerSample& c, std::size_t) { return static_cast<double>(c.status); }},
    {"iterations", [](const PlannerSample& c, std::size_t) { return static_cast<double>(c.iterations); }},
    {"dynamics_defect_max", [](const PlannerSample& c, std::size_t) { return c.dynamics_defect_max; }},
    {"equality_violation_max", [](const PlannerSample& c, std::size_t) { return c.equality_violation_max; }},
    {"friction_cone_violation_max_N",
     [](const PlannerSample& c, std::size_t) { return c.violations.friction_cone_violation_max_N; }},
    {"pulling_force_max_N",
     [](const PlannerSample& c, std::size_t) { return c.violations.pulling_force_max_N; }},
    {"torque_violation_max_Nm",
     [](const PlannerSample& c, std::size_t) { return c.violations.torque_violation_max_Nm; }},
    {"cost", [](const PlannerSample& c, std::size_t) { return c.cost; }},
    {"solve_ms", [](const PlannerSample& c, std::size_t) { return 1e-3 * c.solve_us; }},
};

const std::vector<Column<PlanNodeSample>> kPlanColumns = {
    {"base_x_m", [](const PlanNodeSample& n, std::size_t) { return n.base_x_m; }},
    {"base_z_m", [](const PlanNodeSample& n, std::size_t) { return n.base_z_m; }},
    {"pitch_rad", [](const PlanNodeSample& n, std::size_t) { return n.pitch_rad; }},
    {"foot_position_m", [](const PlanNodeSample& n, std::size_t k) { return n.foot_position_m[k]; }, 4},
    {"contact_force_N", [](const PlanNodeSample& n, std::size_t k) { return n.contact_force_N[k]; }, 4},
    {"left_stance", [](const PlanNodeSample& n, std::size_t) { return n.left_stance ? 1.0 : 0.0; }},
    {"right_stance", [](const PlanNodeSample& n, std::size_t) { return n.right_stance ? 1.0 : 0.0; }},
};

const std::vector<Column<TruthSample>> kTruthColumns = {
    {"contact_force_N", [](const TruthSample& t, std::size_t k) { return t.contact_force_N[k]; }, 4},
    {"push_N", [](const TruthSample& t, std::size_t) { return t.push_N; }},
    {"push_above_hip_m", [](const TruthSample& t, std::size_t) { return t.push_above_hip_m; }},
};

}  // namespace

nlohmann::ordered_json all_column_names() {
  return {{"ticks", column_names(tick_columns())},
          {"planner", column_names(kPlannerColumns)},
          {"plan", column_names(kPlanColumns)},
          {"truth", column_names(kTruthColumns)}};
}

SharedMessage ticks_message(std::span<const TickSample> ticks) {
  return table_message(Table::ticks, ticks.front().time_s, ticks.front().record.tick, ticks, tick_columns());
}

SharedMessage planner_message(std::span<const PlannerSample> cycles) {
  return table_message(Table::planner, cycles.front().time_s, cycles.front().cycle, cycles, kPlannerColumns);
}

SharedMessage plan_message(const PlanSample& plan) {
  return table_message(Table::plan, plan.time_s, 0, std::span<const PlanNodeSample>(plan.nodes),
                       kPlanColumns);
}

SharedMessage truth_message(std::span<const TruthSample> samples) {
  return table_message(Table::truth, samples.front().time_s, 0, samples, kTruthColumns);
}

}  // namespace stilt::monitor
