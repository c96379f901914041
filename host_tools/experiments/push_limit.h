#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "host_tools/experiments/steps.h"

namespace stilt::experiments {

/// Result of one push.
struct PushTrial {
  double force_N = 0.0;
  bool survived = false;
  double fall_time_s = -1.0;
  bool walks = false;  ///< whether it follows the command, see walks.h; relevant without a push
  double mean_speed_m_s = 0.0;
  std::optional<StepRange> step_length;  ///< of steps that land after the start of the push
  double slip_m = 0.0;                ///< distance that loaded feet slid along the ground since the start of
                                      ///< the push
  double saturated_s = 0.0;           ///< time with a motor at its torque limit since the start of the push
  std::optional<int> recovery_steps;  ///< see steps.h
};

/// Forces to try.
struct PushSearch {
  double coarse_N = 10.0;  ///< the search tries its multiples until one fails
  double fine_N = 1.0;     ///< resolution of the limit
  double largest_N = 300.0;
};

/// Result of find_push_limit().
struct PushLimit {
  /// Largest force survived, such that every smaller force tried was survived too; nothing when the robot
  /// falls without a push.
  std::optional<double> force_N;
  std::vector<PushTrial> trials;  ///< in the order of the attempts, the first one without a push
};

/// Finds the limit of one case (controller, phase of the step, seed). Survival is not monotone in the force.
/// The search tries all multiples of coarse_N from 0 up to the first that is not survived. It then halves the
/// interval below that one to a width of fine_N.
[[nodiscard]] PushLimit find_push_limit(const PushSearch& search,
                                        const std::function<PushTrial(double force_N)>& attempt);

}  // namespace stilt::experiments
