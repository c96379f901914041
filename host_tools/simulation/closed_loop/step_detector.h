#pragma once

#include <array>
#include <vector>

#include "host_tools/recording/run_record.h"
#include "mpc_core/model/types.h"

namespace stilt::simulation {

/// Detects touch-downs from contact forces: a foot that carried less than 5 N for at least 50 ms, and then
/// more.
class StepDetector {
 public:
  static constexpr double kShortestSwing_s = 0.05;

  /// Call at each tick, with forces fx_L, fz_L, fx_R, fz_R (N) and positions xL, zL, xR, zR (m).
  void update(double time_s, const model::FeetVector& contact_force_N,
              const model::FeetVector& foot_position_m, double hip_x_m);

  /// Nothing is known of the feet at this tick: a swing that was on counts no more.
  void forget_swings() { airborne_since_s_.fill(-1.0); }

  [[nodiscard]] const std::vector<log::Step>& steps() const { return steps_; }

 private:
  /// Time at which each foot left the ground; negative while it is on the ground.
  std::array<double, model::kFeet> airborne_since_s_ = {-1.0, -1.0};
  std::vector<log::Step> steps_;
};

}  // namespace stilt::simulation
