#pragma once

#include <functional>
#include <optional>
#include <vector>

namespace stilt::experiments {

/// What one push did.
struct PushTrial {
  double force_N = 0.0;
  bool survived = false;
  double fall_time_s = -1.0;
  double step_length_min_m = 0.0, step_length_max_m = 0.0;  ///< over the whole run
  double slip_m = 0.0;       ///< way of loaded feet along the ground, over the whole run
  double saturated_s = 0.0;  ///< time with a motor at its torque limit
};

/// How the forces are tried.
struct PushSearch {
  double coarse_N = 10.0;  ///< every multiple of it is tried until one fails
  double fine_N = 1.0;     ///< the limit is found to this
  double largest_N = 300.0;
};

struct PushLimit {
  /// Largest force survived, with every smaller one that was tried survived, too; nothing when the robot
  /// falls without a push.
  std::optional<double> force_N;
  std::vector<PushTrial> trials;  ///< in the order of the attempts, the first without a push
};

/// The limit of one case (controller, phase of the step, seed). Survival is not monotone in the force: all
/// multiples of coarse_N are tried from 0 up to the first that is not survived, then the interval below that
/// one is halved until it is fine_N wide.
[[nodiscard]] PushLimit find_push_limit(const PushSearch& search,
                                        const std::function<PushTrial(double force_N)>& attempt);

}  // namespace stilt::experiments
