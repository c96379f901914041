#include "host_tools/monitor/page_tables.h"

#include <array>

#include "host_tools/monitor/table_message.h"

namespace stilt::monitor {
namespace {

constexpr std::array kTickColumns = {
    Column<TickSample>{"state", [](const TickSample& t, std::size_t k) { return t.estimated_state[k]; },
                       kStates},
    Column<TickSample>{"commanded_position_rad",
                       [](const TickSample& t, std::size_t k) { return t.commanded_position_rad[k]; },
                       kJoints},
    Column<TickSample>{"commanded_torque_Nm",
                       [](const TickSample& t, std::size_t k) { return t.commanded_torque_Nm[k]; }, kJoints},
    Column<TickSample>{"measured_torque_Nm",
                       [](const TickSample& t, std::size_t k) { return t.measured_torque_Nm[k]; }, kJoints},
    Column<TickSample>{"ramp", [](const TickSample& t, std::size_t) { return t.ramp; }},
    Column<TickSample>{"plan_age_ms", [](const TickSample& t, std::size_t) { return 1e3 * t.plan_age_s; }},
    Column<TickSample>{"wakeup_us", [](const TickSample& t, std::size_t) { return t.wakeup_us; }},
    Column<TickSample>{"execution_us", [](const TickSample& t, std::size_t) { return t.execution_us; }},
    Column<TickSample>{"round_trip_us", [](const TickSample& t, std::size_t) { return t.round_trip_us; }},
    Column<TickSample>{"state_number",
                       [](const TickSample& t, std::size_t) { return static_cast<double>(t.state); }},
    Column<TickSample>{"rung", [](const TickSample& t, std::size_t) { return static_cast<double>(t.rung); }},
};

constexpr std::array kPlannerColumns = {
    Column<PlannerSample>{"status",
                          [](const PlannerSample& c, std::size_t) { return static_cast<double>(c.status); }},
    Column<PlannerSample>{
        "iterations", [](const PlannerSample& c, std::size_t) { return static_cast<double>(c.iterations); }},
    Column<PlannerSample>{"defect_max", [](const PlannerSample& c, std::size_t) { return c.defect_max; }},
    Column<PlannerSample>{"equality_violation_max",
                          [](const PlannerSample& c, std::size_t) { return c.equality_violation_max; }},
    Column<PlannerSample>{"cost", [](const PlannerSample& c, std::size_t) { return c.cost; }},
    Column<PlannerSample>{"solve_ms", [](const PlannerSample& c, std::size_t) { return 1e-3 * c.solve_us; }},
};

constexpr std::array kPlanColumns = {
    Column<PlanKnot>{"hip_x_m", [](const PlanKnot& n, std::size_t) { return n.hip_x_m; }},
    Column<PlanKnot>{"hip_z_m", [](const PlanKnot& n, std::size_t) { return n.hip_z_m; }},
    Column<PlanKnot>{"pitch_rad", [](const PlanKnot& n, std::size_t) { return n.pitch_rad; }},
    Column<PlanKnot>{"foot_position_m", [](const PlanKnot& n, std::size_t k) { return n.foot_position_m[k]; },
                     4},
    Column<PlanKnot>{"contact_force_N", [](const PlanKnot& n, std::size_t k) { return n.contact_force_N[k]; },
                     4},
    Column<PlanKnot>{"carries",
                     [](const PlanKnot& n, std::size_t k) {
                       return (k == 0 ? n.left_carries : n.right_carries) ? 1.0 : 0.0;
                     },
                     2},
};

constexpr std::array kTruthColumns = {
    Column<TruthSample>{"contact_force_N",
                        [](const TruthSample& t, std::size_t k) { return t.contact_force_N[k]; }, 4},
    Column<TruthSample>{"push_N", [](const TruthSample& t, std::size_t) { return t.push_N; }},
    Column<TruthSample>{"push_above_hip_m",
                        [](const TruthSample& t, std::size_t) { return t.push_above_hip_m; }},
};

}  // namespace

nlohmann::ordered_json all_column_names() {
  return {{"ticks", column_names(kTickColumns)},
          {"planner", column_names(kPlannerColumns)},
          {"plan", column_names(kPlanColumns)},
          {"truth", column_names(kTruthColumns)}};
}

SharedMessage ticks_message(std::span<const TickSample> ticks) {
  return table_message(Table::ticks, ticks.front().time_s, ticks.front().tick, ticks, kTickColumns);
}

SharedMessage planner_message(std::span<const PlannerSample> cycles) {
  return table_message(Table::planner, cycles.front().time_s, cycles.front().cycle, cycles, kPlannerColumns);
}

SharedMessage plan_message(const PlanSample& plan) {
  return table_message(Table::plan, plan.time_s, 0, std::span<const PlanKnot>(plan.knots), kPlanColumns);
}

SharedMessage truth_message(std::span<const TruthSample> samples) {
  return table_message(Table::truth, samples.front().time_s, 0, samples, kTruthColumns);
}

}  // namespace stilt::monitor
