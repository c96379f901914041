#include "host_tools/gait_synthesis/likely_mistake.h"

#include <numbers>
#include <stdexcept>
#include <utility>

#include "host_tools/gait_synthesis/gait_check.h"
#include "host_tools/gait_synthesis/gait_metrics.h"

namespace stilt::gait_synthesis {
namespace {

using gait::GaitOutputs;

constexpr int kStanceHip = 0, kStanceKnee = 1, kSwingHip = 2, kSwingKnee = 3;

void scale(GaitOutputs& outputs, double factor) {
  for (auto& row : outputs.angle_rad) {
    for (double& angle_rad : row) angle_rad *= factor;
  }
}

void from_thigh(GaitOutputs& outputs, int hip, int knee) {
  for (int i = 0; i <= outputs.degree; ++i) outputs.angle_rad[knee][i] -= outputs.angle_rad[hip][i];
}

/// A correction of the outputs, and the mistake that it assumes.
struct Correction {
  const char* when;
  void (*apply)(GaitOutputs&);
};

constexpr Correction kCorrections[] = {
    {"the angles are taken as degrees", [](GaitOutputs& o) { scale(o, std::numbers::pi / 180.0); }},
    {"the signs of all angles are changed", [](GaitOutputs& o) { scale(o, -1.0); }},
    {"stance and swing leg are exchanged",
     [](GaitOutputs& o) {
       std::swap(o.angle_rad[kStanceHip], o.angle_rad[kSwingHip]);
       std::swap(o.angle_rad[kStanceKnee], o.angle_rad[kSwingKnee]);
     }},
    {"hip and knee of the stance leg are exchanged",
     [](GaitOutputs& o) { std::swap(o.angle_rad[kStanceHip], o.angle_rad[kStanceKnee]); }},
    {"hip and knee of both legs are exchanged",
     [](GaitOutputs& o) {
       std::swap(o.angle_rad[kStanceHip], o.angle_rad[kStanceKnee]);
       std::swap(o.angle_rad[kSwingHip], o.angle_rad[kSwingKnee]);
     }},
    {"the angles of the knees are taken from the torso, not from the thigh",
     [](GaitOutputs& o) {
       from_thigh(o, kStanceHip, kStanceKnee);
       from_thigh(o, kSwingHip, kSwingKnee);
     }},
    {"start and end of the phase are exchanged",
     [](GaitOutputs& o) { std::swap(o.phase_start, o.phase_end); }},
    {"the phase is taken as centimetres",
     [](GaitOutputs& o) {
       o.phase_start *= 0.01;
       o.phase_end *= 0.01;
     }},
};

/// Whether the outputs have a periodic motion that can be walked.
bool walks(const model::RobotModel& robot, gait::HzdGait gait) {
  try {
    complete_motion(robot, gait);
  } catch (const std::runtime_error&) {
    return false;
  }
  const gait_files::GaitMetrics metrics = gait_metrics(robot, gait);
  return metrics.knee_min_rad > 0.0 && metrics.clearance_m > 0.0 && metrics.swing_height_min_m >= 0.0;
}

}  // namespace

std::optional<std::string> likely_mistake(const model::RobotModel& robot, const gait::HzdGait& gait) {
  const bool by_time = gait.outputs.phase == gait::PhaseKind::time;
  for (const Correction& correction : kCorrections) {
    gait::HzdGait corrected = gait;
    correction.apply(corrected.outputs);
    if (by_time && corrected.outputs.phase_end <= corrected.outputs.phase_start) continue;
    if (walks(robot, corrected)) return correction.when;
  }
  return std::nullopt;
}

}  // namespace stilt::gait_synthesis
