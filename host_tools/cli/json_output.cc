#include "host_tools/cli/json_output.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>

#include "host_tools/cli/usage_error.h"
#include "host_tools/recording/sample_log.h"

namespace stilt::cli {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const model::JointVector& values) { return {values[0], values[1], values[2], values[3]}; }

[[noreturn]] void refuse_output(const std::string& option, const std::string& path,
                                const std::string& reason) {
  throw UsageError(option + " " + path + ": the file cannot be written (" + reason +
                   "); name one in an existing, writable folder");
}

}  // namespace

Json to_json(const log::Percentiles& percentiles) {
  return {{"p50", percentiles.p50}, {"p99", percentiles.p99}, {"max", percentiles.max}};
}

Json plant_json(const log::RunSummary& summary) {
  Json steps = Json::array();
  for (const log::Step& step : summary.steps) {
    steps.push_back({{"time_s", step.time_s}, {"foot", step.foot}, {"length_m", step.length_m}});
  }
  Json json;
  json["survived"] = summary.survived;
  json["fall_time_s"] = summary.fall_time_s < 0.0 ? Json(nullptr) : Json(summary.fall_time_s);
  json["fall_margin_min"] = summary.fall_margin_min;
  json["duration_s"] = summary.duration_s;
  json["distance_m"] = summary.distance_m;
  json["mean_speed_m_s"] = summary.mean_speed_m_s;
  json["steps"] = std::move(steps);
  json["step_length_min_m"] = summary.step_length_min_m;
  json["step_length_max_m"] = summary.step_length_max_m;
  json["peak_torque_Nm"] = to_json(summary.peak_torque_Nm);
  json["peak_joint_speed_rad_s"] = to_json(summary.peak_joint_speed_rad_s);
  json["slip_distance_m"] = summary.slip_distance_m;
  return json;
}

Json to_json(const log::RunSummary& summary) {
  Json json = plant_json(summary);
  json["saturated_s"] = summary.saturated_s;
  json["solve_time_us"] = to_json(summary.solve_time_us);
  json["sqp_iterations"] = {{"mean", summary.sqp_iterations_mean}, {"max", summary.sqp_iterations_max}};
  json["dynamics_defect_max"] = summary.dynamics_defect_max;
  json["equality_violation_max"] = summary.equality_violation_max;
  const log::PlanInUse& plan = summary.plan_in_use;
  json["plan_in_use"] = {
      {"defect_max", plan.defect_max},
      {"equality_violation_max", plan.equality_violation_max},
      {"cone_violation_max_N", plan.cone_violation_max_N},
      {"normal_force_min_N",
       std::isfinite(plan.normal_force_min_N) ? Json(plan.normal_force_min_N) : Json(nullptr)}};
  json["heap_allocations_in_loop"] = summary.heap_allocations_in_loop;
  json["controller_bytes"] = summary.controller_bytes;
  for (std::size_t level = 0; level < supervisor::kFallbackLevels; ++level) {
    json["fallback_s"][supervisor::name(static_cast<supervisor::FallbackLevel>(level))] =
        summary.fallback_s[level];
  }
  json["fallback_s"]["tuck"] =
      0.0;  // for scripts; no such level: a falling robot is damped (docs/hazards.md)
  return json;
}

void check_output_files(const OutputFiles& outputs, const std::vector<std::string>& inputs) {
  for (const auto& [option, path] : outputs) {
    const std::string reason = diagnostics::why_not_writable(path);
    if (!reason.empty()) refuse_output(option, path, reason);
  }
  const std::string conflict = diagnostics::conflict(outputs, inputs);
  if (!conflict.empty()) throw UsageError(conflict);
}

void check_output_folder(const std::string& folder) {
  if (folder == "-") throw UsageError("--out -: several files are written; name a folder");
}

bool on_standard_output(const OutputFiles& outputs) {
  return std::ranges::find(outputs, "-", &diagnostics::NamedFile::path) != outputs.end();
}

void write_output_file(const std::string& option, const std::string& path, std::string_view text) {
  const auto written = diagnostics::write_file(path, text);
  if (!written) refuse_output(option, path, written.error());
  if (path != "-") std::fprintf(stderr, "written: %s\n", path.c_str());
}

void write_json(const Json& json, const std::string& path) {
  write_output_file("--json", path, json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
}

void write_log(const log::RunRecord& record, const std::string& path) {
  if (path.empty()) return;
  log::write_sample_log(record, path);
  if (path != "-") std::fprintf(stderr, "written: %s\n", path.c_str());
}

void write_each(std::initializer_list<std::function<void()>> writers) {
  std::string complaints;
  for (const std::function<void()>& write : writers) {
    try {
      write();
    } catch (const std::exception& error) {
      complaints += (complaints.empty() ? "" : "; ") + std::string(error.what());
    }
  }
  if (!complaints.empty()) throw UsageError(complaints);
}

}  // namespace stilt::cli
