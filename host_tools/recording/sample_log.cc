#include "host_tools/recording/sample_log.h"

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "firmware/diagnostics/output_file.h"

namespace stilt::log {
namespace {

using Json = nlohmann::ordered_json;

template <class Vector>
Json array(const Vector& values) {
  Json result = Json::array();
  for (const double value : values) result.push_back(value);
  return result;
}

Json to_json(const RunSample& sample) {
  Json json;
  json["time_s"] = sample.time_s;
  json["true_state"] = array(sample.true_state);
  json["estimated_state"] = array(sample.estimated_state);
  json["planned_state"] = array(sample.planned_state);
  json["torque_Nm"] = array(sample.torque_Nm);
  json["contact_force_N"] = array(sample.contact_force_N);
  json["planned_contact_force_N"] = array(sample.planned_contact_force_N);
  json["foot_position_m"] = array(sample.foot_position_m);
  json["scheduled_contact"] = {sample.scheduled_mode.left, sample.scheduled_mode.right};
  json["push_N"] = sample.push_N;
  json["push_above_hip_m"] = sample.push_above_hip_m;
  json["commanded_speed_m_s"] = sample.commanded_speed_m_s;
  return json;
}

}  // namespace

void write_sample_log(const RunRecord& record, const std::string& file) {
  auto sample = record.samples.begin();
  std::string line;
  const auto written = diagnostics::write_file(file, [&]() -> std::string_view {
    if (sample == record.samples.end()) return {};
    line = to_json(*sample++).dump() + '\n';
    return line;
  });
  if (written) return;
  throw std::runtime_error("--log " + file + ": cannot be written (" + written.error() +
                           "); name a file in a writable folder");
}

}  // namespace stilt::log
