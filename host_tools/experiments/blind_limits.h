#pragma once

#include <string>
#include <vector>

#include "host_tools/experiments/job_folder.h"
#include "host_tools/experiments/limit_search.h"
#include "host_tools/experiments/walk_case.h"

/// Changes that the robot survives although nothing announces them. Of ground and robot the controller has no
/// parameter. The others are the delay of its plans and the commanded speed.
namespace stilt::experiments {

/// One quantity that changes in one direction.
struct BlindQuantity {
  std::string name;  ///< for jobs and --quantity
  std::string quantity, unit, direction;
  double nominal = 0.0;
  LimitSearch search;       ///< search over the difference from nominal
  bool has_phases = false;  ///< whether the change occurs at every phase of the step
  /// Changes the case. `phase_m`: additional distance to the change, for quantities with phases.
  void (*apply)(double value, double phase_m, WalkCase& walk);
  bool (*passes)(const WalkCase& walk, const log::RunSummary& summary);
};

/// Height of a step in the ground, slope, speed, friction, mass, delay of the plan and of the torque.
[[nodiscard]] const std::vector<BlindQuantity>& blind_quantities();

/// The limits to search, and the settings of the search.
struct LimitPlan {
  struct Controller {
    std::string name = "mpc-heuristic";
    double horizon_s = 1.0;
    double step_time_s = 0.3;  ///< step time of its gait, to place the phases
  };
  std::vector<Controller> controllers = {{}};
  std::vector<BlindQuantity> quantities = blind_quantities();
  int phases = 8;  ///< phases of the step; odd ones with the other foot
  int seeds = 3;   ///< 1, 2, ... of the sensor noise
  double duration_s = 20.0;
  double speed_m_s = 0.5;  ///< commanded, except when it is the quantity
  int sequences = 10;      ///< of random commands, seeds 1, 2, ...
  double sequence_s = 60.0;
};

/// The walk of one case at a value of the quantity.
[[nodiscard]] WalkCase limit_case(const LimitPlan& plan, const LimitPlan::Controller& controller,
                                  const BlindQuantity& quantity, int phase, int seed, double value);

/// The walk of one random sequence of commands.
[[nodiscard]] WalkCase sequence_case(const LimitPlan& plan, const LimitPlan::Controller& controller,
                                     int seed);

/// One job per controller, quantity, phase and seed: {phase, seed, limit, first_fall, trials: [{value,
/// passed, survived, fall_time_s, mean_speed_m_s}]}. Then one job per controller and sequence: {seed,
/// survived, fall_time_s, commands: [{start_s, gait, speed_m_s}]}.
[[nodiscard]] std::vector<Job> limit_jobs(const LimitPlan& plan, const WalkRunner& run);

/// Merges the results to one object:
///
///   {rows: [{controller, horizon_s, duration_s, speed_m_s, name, quantity, unit, direction, nominal,
///            limit_all, limit_half, phases, cases, falls, coarse, fine, last_tried, speed_min_m_s,
///            speed_max_m_s, limits, worst_cases: [{phase, seed, limit}]}],
///    sequences: [{controller, horizon_s, survived, of, duration_s, runs}]}
///
/// limit_all is the value that every case passes, limit_half the value that half of them pass; null when
/// those fail at the nominal value. falls: number of cases with a first failure; the others pass up to
/// last_tried. Speeds: mean speeds of the walks at their own limits.
[[nodiscard]] Json merge_limits(const LimitPlan& plan, const std::vector<Json>& results);

/// Rows and sequences as Markdown tables.
[[nodiscard]] std::string limit_table(const Json& merged);

}  // namespace stilt::experiments
