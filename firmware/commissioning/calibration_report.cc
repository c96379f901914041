#include <nlohmann/json.hpp>

#include "firmware/commissioning/calibrate.h"
#include "firmware/commissioning/json_number.h"
#include "firmware/commissioning/json_text.h"
#include "firmware/commissioning/values_report.h"
#include "firmware/control_loop/joint_names.h"

namespace stilt::commissioning {
namespace {

using Json = nlohmann::ordered_json;

Json fit_json(const LagFit& fit) {
  return {
      {"gain", json_number(fit.gain)}, {"delay_s", fit.delay_s}, {"explained", json_number(fit.explained)}};
}

}  // namespace

std::string to_text(const CalibrationReport& report) {
  std::string text;
  for (const JointCalibration& joint : report.joints) text += joint.sentence + '\n';
  text += report.torso.sentence + '\n';
  return text + values_text(report.values);
}

std::string to_json(const CalibrationReport& report, const std::string& file) {
  Json json;
  json["good"] = report.good();
  json["reference"] = report.reference == Reference::stops ? "stops" : "marks";
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    const JointCalibration& result = report.joints[joint];
    json["joints"][control_loop::kJointNames[joint]] = {{"finding", name(result.finding)},
                                                        {"sentence", result.sentence},
                                                        {"reversed", result.reversed},
                                                        {"offset_rad", result.offset_rad},
                                                        {"travel_share", json_number(result.travel_share)}};
  }
  const TorsoCalibration& torso = report.torso;
  json["torso"] = {{"finding", name(torso.finding)},
                   {"sentence", torso.sentence},
                   {"reversed", torso.reversed},
                   {"rate_reversed", torso.rate_reversed},
                   {"offset_rad", torso.offset_rad},
                   {"rest_pitch_rad", json_number(torso.motion.rest_pitch_rad)},
                   {"pitch", fit_json(torso.motion.pitch)},
                   {"rate", fit_json(torso.motion.rate)}};
  json["values"] = values_json(report.values);
  json["written"] = file.empty() ? Json(nullptr) : Json(file);
  return json_text(json);
}

}  // namespace stilt::commissioning
