#include "host_tools/web/report/run_data.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "host_tools/web/report/packed_columns.h"
#include "mpc_core/sqp/solve_status_names.h"

namespace stilt::report {
namespace {

using Json = nlohmann::ordered_json;

std::size_t ceiling_ratio(std::size_t numerator, std::size_t denominator) {
  return std::max<std::size_t>(1, (numerator + denominator - 1) / denominator);
}

Json joints_json(const model::JointVector& joints) {
  return Json::array({joints[0], joints[1], joints[2], joints[3]});
}

Json percentiles_json(const log::Percentiles& percentiles) {
  return {{"p50", percentiles.p50}, {"p99", percentiles.p99}, {"max", percentiles.max}};
}

Json steps_json(const std::vector<log::Step>& steps) {
  Json list = Json::array();
  for (const log::Step& step : steps) {
    list.push_back({{"time_s", step.time_s}, {"foot", step.foot}, {"length_m", step.length_m}});
  }
  return list;
}

Json summary_json(const log::RunSummary& summary, bool outcome_known) {
  return {
      {"survived", outcome_known ? Json(summary.survived) : Json(nullptr)},
      {"fall_time_s", summary.fall_time_s < 0.0 ? Json(nullptr) : Json(summary.fall_time_s)},
      {"duration_s", summary.duration_s},
      {"distance_m", summary.distance_m},
      {"mean_speed_m_s", summary.mean_speed_m_s},
      {"steps", steps_json(summary.steps)},
      {"steps_known", summary.steps_known},
      {"step_length_min_m", summary.step_length_min_m},
      {"step_length_max_m", summary.step_length_max_m},
      {"peak_torque_Nm", joints_json(summary.peak_torque_Nm)},
      {"peak_joint_speed_rad_s", joints_json(summary.peak_joint_speed_rad_s)},
      {"slip_distance_m", summary.slip_distance_m},
      {"solve_time_us", percentiles_json(summary.solve_time_us)},
      {"sqp_iterations", {{"mean", summary.sqp_iterations_mean}, {"max", summary.sqp_iterations_max}}},
      {"dynamics_defect_max", summary.dynamics_defect_max},
      {"equality_violation_max", summary.equality_violation_max},
      {"heap_allocations_in_loop", summary.heap_allocations_in_loop},
      {"controller_bytes", summary.controller_bytes},
  };
}

Json controller_json(const std::optional<log::ControllerPart>& controller) {
  if (!controller) return nullptr;
  Json events = Json::array();
  for (const log::RunEvent& event : controller->events) {
    events.push_back({{"time_s", event.time_s}, {"text", event.text}});
  }
  return {{"last_state", controller->last_state}, {"events", events}};
}

Json missing_json(const std::vector<log::MissingTicks>& missing) {
  Json list = Json::array();
  for (const log::MissingTicks& one : missing) {
    list.push_back({{"first", one.first}, {"last", one.last}, {"from_s", one.from_s}, {"to_s", one.to_s}});
  }
  return list;
}

Json settings_json(const std::vector<log::Setting>& settings) {
  Json values = Json::object();
  for (const log::Setting& setting : settings) values[setting.key] = setting.value;
  return values;
}

Json ticks_json(const std::vector<log::RunSample>& all) {
  const std::size_t stride = ceiling_ratio(all.size(), kMaxSamples);
  PackedColumns columns(ceiling_ratio(all.size(), stride) * (all.empty() ? 0 : 1));
  const auto add = [&](const char* name, int width, auto value) {
    columns.add(name, width, [&](std::size_t row, int k) { return value(all[row * stride], k); });
  };
  using Sample = log::RunSample;
  add("time_s", 1, [](const Sample& s, int) { return s.time_s; });
  add("true_state", model::kStates, [](const Sample& s, int k) { return s.true_state[k]; });
  add("estimated_state", model::kStates, [](const Sample& s, int k) { return s.estimated_state[k]; });
  add("planned_state", model::kStates, [](const Sample& s, int k) { return s.planned_state[k]; });
  add("torque_Nm", model::kJoints, [](const Sample& s, int k) { return s.torque_Nm[k]; });
  add("contact_force_N", 4, [](const Sample& s, int k) { return s.contact_force_N[k]; });
  add("planned_contact_force_N", 4, [](const Sample& s, int k) { return s.planned_contact_force_N[k]; });
  add("foot_position_m", 4, [](const Sample& s, int k) { return s.foot_position_m[k]; });
  add("scheduled_mode", model::kFeet, [](const Sample& s, int k) { return int{s.scheduled_mode[k]}; });
  add("push_N", 1, [](const Sample& s, int) { return s.push_N; });
  add("push_above_hip_m", 1, [](const Sample& s, int) { return s.push_above_hip_m; });
  add("commanded_speed_m_s", 1, [](const Sample& s, int) { return s.commanded_speed_m_s; });
  Json json = columns.json();
  json["stride"] = stride;
  return json;
}

/// Indices of the nodes kept for drawing.
std::vector<std::size_t> drawn_nodes(const log::PlanSnapshot& plan) {
  const std::size_t count = std::min({plan.node_time_s.size(), plan.base_x_m.size(), plan.base_z_m.size(),
                                      plan.pitch_rad.size(), plan.foot_position_m.size()});
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < count; ++k) {
    const bool far_enough =
        kept.empty() || plan.node_time_s[k] >= plan.node_time_s[kept.back()] + kPlanNodeSpacing_s;
    if (far_enough || k + 1 == count) kept.push_back(k);
  }
  return kept;
}

struct NodeReference {
  const log::PlanSnapshot* plan;
  std::size_t node;
};

Json plans_json(const std::vector<log::PlanSnapshot>& plans) {
  std::size_t all_nodes = 0;
  for (const log::PlanSnapshot& plan : plans) all_nodes += drawn_nodes(plan).size();
  const std::size_t stride = ceiling_ratio(all_nodes, kMaxPlanNodes);

  std::vector<NodeReference> nodes;
  Json plan_time = Json::array();
  Json first_node = Json::array();
  for (std::size_t i = 0; i < plans.size(); i += stride) {
    plan_time.push_back(plans[i].time_s);
    first_node.push_back(nodes.size());
    for (const std::size_t node : drawn_nodes(plans[i])) nodes.push_back({&plans[i], node});
  }

  PackedColumns columns(nodes.size());
  const auto at = [&](std::size_t row) -> const NodeReference& { return nodes[row]; };
  columns.add("time_s", 1, [&](std::size_t row, int) { return at(row).plan->node_time_s[at(row).node]; });
  columns.add("base_x_m", 1, [&](std::size_t row, int) { return at(row).plan->base_x_m[at(row).node]; });
  columns.add("base_z_m", 1, [&](std::size_t row, int) { return at(row).plan->base_z_m[at(row).node]; });
  columns.add("pitch_rad", 1, [&](std::size_t row, int) { return at(row).plan->pitch_rad[at(row).node]; });
  columns.add("foot_position_m", 4,
              [&](std::size_t row, int k) { return at(row).plan->foot_position_m[at(row).node][k]; });
  return {{"time_s", plan_time}, {"first_node", first_node}, {"stride", stride}, {"nodes", columns.json()}};
}

Json planner_json(const std::vector<log::SolveSample>& solves) {
  PackedColumns columns(solves.size());
  const auto add = [&](const char* name, auto value) {
    columns.add(name, 1, [&](std::size_t row, int) { return value(solves[row]); });
  };
  using Solve = log::SolveSample;
  add("time_s", [](const Solve& s) { return s.time_s; });
  add("solve_ms", [](const Solve& s) { return 1e-3 * s.solve_us; });
  add("status", [](const Solve& s) { return static_cast<int>(s.report.status); });
  add("iterations", [](const Solve& s) { return s.report.iterations; });
  add("dynamics_defect_max", [](const Solve& s) { return s.report.dynamics_defect_max; });
  add("equality_violation_max", [](const Solve& s) { return s.report.equality_violation_max; });
  add("friction_cone_violation_max_N",
      [](const Solve& s) { return s.report.violations.friction_cone_violation_max_N; });
  add("pulling_force_max_N", [](const Solve& s) { return s.report.violations.pulling_force_max_N; });
  add("torque_violation_max_Nm", [](const Solve& s) { return s.report.violations.torque_violation_max_Nm; });
  Json json = columns.json();
  json["status_names"] = sqp::kSolveStatusNames;
  return json;
}

}  // namespace

std::string run_data_json(const log::RunRecord& record) {
  const Json json = {
      {"command_line", record.command_line},
      {"robot",
       {{"name", record.robot.name},
        {"torso_length_m", record.robot.torso_length_m},
        {"thigh_length_m", record.robot.thigh_length_m},
        {"shin_length_m", record.robot.shin_length_m}}},
      {"torque_limit_Nm", record.torque_limit_Nm},
      {"allowed_torque_Nm", record.allowed_torque_Nm},
      {"friction_coefficient", record.friction_coefficient},
      {"ground", {{"x_m", record.ground_x_m}, {"z_m", record.ground_z_m}}},
      {"summary", summary_json(record.summary, record.outcome_known)},
      {"controller", controller_json(record.controller)},
      {"settings", settings_json(record.settings)},
      {"ticks", ticks_json(record.samples)},
      {"missing_ticks", missing_json(record.missing_ticks)},
      {"plans", plans_json(record.plans)},
      {"planner", planner_json(record.solves)},
  };
  constexpr int kNoIndent = -1;
  constexpr bool kAsciiOnly = true;
  return json.dump(kNoIndent, ' ', kAsciiOnly, Json::error_handler_t::replace);
}

}  // namespace stilt::report
