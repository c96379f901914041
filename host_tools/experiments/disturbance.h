#pragma once

#include <string>
#include <vector>

#include "host_tools/experiments/job_folder.h"
#include "host_tools/experiments/push_limit.h"
#include "host_tools/experiments/walk_case.h"

namespace stilt::experiments {

/// The second table of the paper: the largest forward push of one second that each controller survives while
/// walking.
struct DisturbancePlan {
  struct Row {
    std::string controller;
    double horizon_s = 1.0;
    double step_s = 0.3;  ///< of the controller's gait, to place the phases
  };
  std::vector<Row> rows;
  int phases = 8;           ///< of the step, at which the push begins; odd ones with the other foot in stance
  int seeds = 3;            ///< 1, 2, ... of the sensor noise
  double settled_s = 4.2;   ///< no push before
  double recovery_s = 4.5;  ///< after the push, on its feet
  double speed_m_s = 0.5;
  double push_duration_s = 1.0;
  PushSearch search;
};

/// Five controllers at horizons 2.0, 0.5 and 0.2 s; hzd-pd plans nothing and stands there once.
[[nodiscard]] std::vector<DisturbancePlan::Row> published_rows();

/// Time at which the push of a phase begins.
[[nodiscard]] double push_start_s(const DisturbancePlan& plan, const DisturbancePlan::Row& row, int phase);

/// One job a row, phase and seed: {controller, horizon_s, phase, seed, limit_N, trials}.
[[nodiscard]] std::vector<Job> disturbance_jobs(const DisturbancePlan& plan, const WalkRunner& run);

/// The jobs' results as {rows: [{controller, horizon_s, push_all_phases_N, push_half_phases_N, paper_N,
/// step_length_range_m, step_length_min_m, step_length_max_m, first_slip_N, saturated_s, cases, walks,
/// limits_N}]}.
///
/// push_all_phases_N is the smallest of the limits over phases and seeds, push_half_phases_N the largest
/// force that half of them reach; null when those fall without a push. Step lengths: over all survived
/// runs. first_slip_N: smallest force under which a survived run slips 10 mm farther than without a push.
/// saturated_s: longest time in a survived run with a motor at its torque limit. walks: cases that walk
/// without a push.
[[nodiscard]] Json merge_disturbance(const DisturbancePlan& plan, const std::vector<Json>& results);

/// The rows as a Markdown table.
[[nodiscard]] std::string disturbance_table(const Json& merged);

}  // namespace stilt::experiments
