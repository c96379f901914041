#include "host_tools/simulation/closed_loop/step_detector.h"

namespace stilt::simulation {
namespace {

constexpr double kLoaded_N = 5.0;

}  // namespace

void StepDetector::update(double time_s, const model::FeetVector& contact_force_N,
                          const model::FeetVector& foot_position_m, double hip_x_m) {
  for (int foot = 0; foot < model::kFeet; ++foot) {
    double& since_s = airborne_since_s_[static_cast<std::size_t>(foot)];
    if (contact_force_N[2 * foot + 1] <= kLoaded_N) {
      if (since_s < 0.0) since_s = time_s;
      continue;
    }
    if (since_s >= 0.0 && time_s - since_s >= kShortestSwing_s) {
      const double length_m = foot_position_m[2 * foot] - foot_position_m[2 * (1 - foot)];
      steps_.push_back({time_s, foot == model::kLeft ? "L" : "R", length_m, hip_x_m});
    }
    since_s = -1.0;
  }
}

}  // namespace stilt::simulation
