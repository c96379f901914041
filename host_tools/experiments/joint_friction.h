#pragma once

#include <string>
#include <vector>

#include "host_tools/experiments/job_folder.h"
#include "host_tools/experiments/walk_case.h"

namespace stilt::experiments {

/// Experiment: what the joints' Coulomb friction adds to their position error, and what its compensation
/// takes away. Sensors have no noise: at high rates it would be larger than what friction adds.
struct FrictionPlan {
  struct Rate {
    double plan_rate_hz;
    double plan_delay_s;  ///< of a plan, at most the time between two
  };
  std::string controller = "mpc-heuristic";
  double horizon_s = 1.0;
  double friction_Nm = 5.0;  ///< of every joint
  std::vector<Rate> rates = {{25.0, 0.02}, {50.0, 0.02}, {100.0, 0.01}, {500.0, 0.002}};
  double duration_s = 20.0;
  gait::GaitCommand command{gait::GaitKind::walk, 0.5};
};

/// Three jobs per rate of plans: {survived, joint_error_rad}. The joints have no friction; friction that the
/// configuration of the controller does not name; friction that it names. The error is the root mean square
/// over joints and control ticks of planned less true joint position.
[[nodiscard]] std::vector<Job> friction_jobs(const FrictionPlan& plan, const WalkRunner& run);

/// {rows: [{controller, horizon_s, friction_Nm, duration_s, plan_rate_hz, plan_delay_s, survived,
/// no_friction_rad, unknown_rad, configured_rad, configured_over_unknown}]}.
[[nodiscard]] Json merge_friction(const FrictionPlan& plan, const std::vector<Json>& results);

/// The rows as a Markdown table.
[[nodiscard]] std::string friction_table(const Json& merged);

}  // namespace stilt::experiments
