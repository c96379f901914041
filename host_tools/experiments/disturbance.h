#pragma once

#include <string>
#include <vector>

#include "host_tools/experiments/job_folder.h"
#include "host_tools/experiments/push_limit.h"
#include "host_tools/experiments/walk_case.h"

namespace stilt::experiments {

/// One row of a table of pushes: a controller, its setting, and the direction of the push.
struct PushRow {
  std::string name;  ///< unique in the plan; begins the names of the jobs
  std::string robot = "amber3m";
  std::string controller = "mpc-heuristic";
  double horizon_s = 1.0;
  gait::GaitCommand command{gait::GaitKind::walk, 0.5};
  bool backward = false;     ///< direction of the push
  double step_time_s = 0.3;  ///< step time of the controller's gait, to place the phases
  int phases = 8;            ///< phases of the step at which the push begins; odd ones with the other foot in
                             ///< stance
  int seeds = 3;             ///< 1, 2, ... of the sensor noise
  PushSearch search;
  Json setting;     ///< other settings of the row, for the reader; its fields become the row's
  WalkRunner walk;  ///< runs a walk of this row
};

/// The second table of the paper: the largest push of one second that each controller survives.
struct DisturbancePlan {
  std::vector<PushRow> rows;
  double settled_s = 4.2;   ///< earliest start of a push
  double recovery_s = 4.5;  ///< time that the robot must stay on its feet after the push
  double push_duration_s = 1.0;
};

/// Controller and horizon of a published row.
struct PublishedRow {
  std::string controller;
  double horizon_s = 0.5;
};

/// Five controllers at horizons 2.0, 0.5 and 0.2 s; hzd-pd plans nothing and occurs once.
[[nodiscard]] std::vector<PublishedRow> published_rows();

/// Time of the first lift-off of a walk at or after `settled_s`, and `steps` steps later.
[[nodiscard]] double lift_off_s(double settled_s, double step_time_s, double steps);

/// Start time of the push at a phase.
[[nodiscard]] double push_start_s(const DisturbancePlan& plan, const PushRow& row, int phase);

/// Runs one push of a case. Its recovery in steps is measured by the commanded speed.
[[nodiscard]] PushTrial push_case(const DisturbancePlan& plan, const PushRow& row, int phase, int seed,
                                  double force_N);

/// One job per row, phase and seed: {name, phase, seed, limit_N, trials}.
[[nodiscard]] std::vector<Job> disturbance_jobs(const DisturbancePlan& plan);

// clang-format off
/// Merges the results of the jobs to {rows: [...]}. Fields of a row, besides those of its setting:
///
/// name, robot, controller, horizon_s, gait, speed_m_s, direction, phases, seeds, coarse_N, fine_N, settled_s,
/// push_duration_s, recovery_s
/// push_all_phases_N     smallest of the limits over phases and seeds; null when that case falls unpushed
/// push_half_phases_N    largest force that half of the cases reach; null likewise
/// limits_N              all limits, ascending
/// worst_cases           [{phase, seed, limit_N}]: the two cases with the smallest limits
/// paper_N               published limit, null where there is none
/// unpushed_speed_m_s    mean over the cases that stay on their feet without a push
/// walks                 all cases walk at the command without a push (see walks.h)
/// cases_walk, cases     how many of them do, of how many
/// step_length_min_m, step_length_max_m, step_length_range_m
///                       of all survived runs, from the start of the push on; null without a step
/// step_length_at_20N_m  {min, max, range} over the cases that survive 20 N, the paper's push; null when none
///                       survived it or 20 N is no multiple of the coarse step
/// first_slip_N          smallest force under which a survived run slips 10 mm farther, from the start of the
///                       push on, than the unpushed run of its case over the same time
/// saturated_s           longest time in a survived run with a motor at its torque limit, from the start of
///                       the push on
/// recovery_steps        {at_20N, at_80_percent}: {force_N, cases, recovered, median, max} of the steps to
///                       recover (see steps.h) over the cases that survive 20 N, and a force of 80 % of
///                       push_all_phases_N, rounded down to a multiple of the coarse step; median and max are
///                       null where such a case does not recover; at_... is null for a robot that stands,
///                       where no case survives that force, or where 20 N is no multiple of the coarse step
// clang-format on
[[nodiscard]] Json merge_disturbance(const DisturbancePlan& plan, const std::vector<Json>& results);

/// The rows as a Markdown table.
[[nodiscard]] std::string disturbance_table(const Json& merged);

}  // namespace stilt::experiments
