#include "host_tools/cli/gait_json.h"

namespace stilt::cli {

nlohmann::ordered_json to_json(const gait_files::GaitRecord& record, const gait_synthesis::GaitCheck& check) {
  const bool by_time = record.gait.outputs.phase == gait::PhaseKind::time;
  nlohmann::ordered_json json;
  json["valid"] = check.valid();
  json["robot"] = record.robot;
  json["speed_m_s"] = record.gait.speed_m_s;
  json["step_time_s"] = record.gait.step_time_s;
  json["step_length_m"] = record.gait.step_length_m;
  json["phase"] = by_time ? "time" : "hip_position";
  json["return_map_spectral_radius"] = check.metrics.return_map_eigenvalues[0];
  gait_files::GaitMetrics metrics = check.metrics;
  for (const auto& field : gait_files::metric_fields()) {
    const auto values = field.values(metrics);
    if (values.size() == 1) {
      json[field.key] = values[0];
    } else {
      json[field.key] = std::vector<double>(values.begin(), values.end());
    }
  }
  json["violations"] = nlohmann::ordered_json::array();
  json["violated_bounds"] = nlohmann::ordered_json::array();
  for (const gait_synthesis::Violation& violation : check.violations) {
    json["violations"].push_back(violation.name);
    json["violated_bounds"].push_back({{"name", violation.name},
                                       {"value", violation.value},
                                       {"kind", gait_synthesis::name(violation.kind)},
                                       {"bound", violation.bound}});
  }
  return json;
}

}  // namespace stilt::cli
