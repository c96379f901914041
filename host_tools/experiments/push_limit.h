#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "host_tools/experiments/steps.h"

namespace stilt::experiments {

/// What one push did.
struct PushTrial {
  double force_N = 0.0;
  bool survived = false;
  double fall_time_s = -1.0;
  bool walks = false;  ///< at the command, see walks.h; of interest without a push
  double mean_speed_m_s = 0.0;
  std::optional<StepRange> step_length;  ///< of steps that land after the start of the push
  double slip_m = 0.0;                ///< way of loaded feet along the ground from the start of the push on
  double saturated_s = 0.0;           ///< with a motor at its torque limit, from the start of the push on
  std::optional<int> recovery_steps;  ///< see steps.h
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
