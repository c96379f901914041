#include "host_tools/experiments/disturbance.h"

#include <cmath>
#include <cstdint>

#include "host_tools/experiments/push_row.h"
#include "host_tools/experiments/table_text.h"
#include "host_tools/experiments/walks.h"

namespace stilt::experiments {
namespace {

Json to_json(const PushTrial& trial) {
  const auto steps = [&](double StepRange::* end) {
    return trial.step_length ? Json((*trial.step_length).*end) : Json(nullptr);
  };
  return {{"force_N", trial.force_N},
          {"survived", trial.survived},
          {"fall_time_s", trial.survived ? Json(nullptr) : Json(trial.fall_time_s)},
          {"walks", trial.walks},
          {"mean_speed_m_s", trial.mean_speed_m_s},
          {"step_length_min_m", steps(&StepRange::min_m)},
          {"step_length_max_m", steps(&StepRange::max_m)},
          {"slip_m", trial.slip_m},
          {"saturated_s", trial.saturated_s},
          {"recovery_steps", trial.recovery_steps ? Json(*trial.recovery_steps) : Json(nullptr)}};
}

/// Walks one case under forces of one direction.
class Case {
 public:
  Case(const DisturbancePlan& plan, const PushRow& row, int phase, int seed)
      : row_(row), unpushed_speed_m_s_(commanded_speed_m_s(row.command)) {
    walk_.controller = row.controller;
    walk_.horizon_s = row.horizon_s;
    walk_.command = row.command;
    walk_.seed = static_cast<std::uint64_t>(seed);
    walk_.push_start_s = walk_.measure_from_s = push_start_s(plan, row, phase);
    walk_.push_duration_s = plan.push_duration_s;
    walk_.duration_s = walk_.push_start_s + plan.push_duration_s + plan.recovery_s;
  }

  /// The first trial has no push: its speed is the reference for the others.
  PushTrial push(double force_N) {
    walk_.push_N = row_.backward ? -force_N : force_N;
    const log::RunSummary summary = row_.walk(walk_).summary;
    if (force_N == 0.0) unpushed_speed_m_s_ = summary.mean_speed_m_s;
    PushTrial trial;
    trial.force_N = force_N;
    trial.survived = summary.survived;
    trial.fall_time_s = summary.fall_time_s;
    trial.walks = walks(row_.command, summary);
    trial.mean_speed_m_s = summary.mean_speed_m_s;
    trial.step_length = step_range(summary.steps, walk_.push_start_s);
    trial.slip_m = summary.slip_distance_m;
    trial.saturated_s = summary.saturated_s;
    if (trial.survived) {
      trial.recovery_steps =
          recovery_steps(summary.steps, walk_.push_start_s + walk_.push_duration_s, unpushed_speed_m_s_);
    }
    return trial;
  }

 private:
  const PushRow& row_;
  WalkCase walk_;
  double unpushed_speed_m_s_;
};

Json run_job(const DisturbancePlan& plan, const PushRow& row, int phase, int seed) {
  Case pushed(plan, row, phase, seed);
  const PushLimit limit = find_push_limit(row.search, [&](double force_N) { return pushed.push(force_N); });
  Json trials = Json::array();
  for (const PushTrial& trial : limit.trials) trials.push_back(to_json(trial));
  return {{"name", row.name},
          {"phase", phase},
          {"seed", seed},
          {"limit_N", limit.force_N ? Json(*limit.force_N) : Json(nullptr)},
          {"trials", std::move(trials)}};
}

}  // namespace

std::vector<PublishedRow> published_rows() {
  std::vector<PublishedRow> rows;
  for (const double horizon_s : {2.0, 0.5, 0.2}) {
    for (const char* controller : {"mpc-lumped", "mpc-none", "mpc-heuristic", "mpc-hzd"}) {
      rows.push_back({controller, horizon_s});
    }
  }
  rows.push_back({"hzd-pd", 0.5});
  return rows;
}

double lift_off_s(double settled_s, double step_time_s, double steps) {
  constexpr double kFirstLiftOff_s = 0.3;
  return kFirstLiftOff_s +
         step_time_s * (std::ceil((settled_s - kFirstLiftOff_s) / step_time_s - 1e-9) + steps);
}

double push_start_s(const DisturbancePlan& plan, const PushRow& row, int phase) {
  return lift_off_s(plan.settled_s, row.step_time_s, phase % 2 + static_cast<double>(phase) / row.phases);
}

PushTrial push_case(const DisturbancePlan& plan, const PushRow& row, int phase, int seed, double force_N) {
  return Case(plan, row, phase, seed).push(force_N);
}

std::vector<Job> disturbance_jobs(const DisturbancePlan& plan) {
  std::vector<Job> jobs;
  for (const PushRow& row : plan.rows) {
    for (int phase = 0; phase < row.phases; ++phase) {
      for (int seed = 1; seed <= row.seeds; ++seed) {
        const std::string id = row.name + "_phase" + std::to_string(phase) + "of" +
                               std::to_string(row.phases) + "_seed" + std::to_string(seed);
        jobs.push_back({id, [=] { return run_job(plan, row, phase, seed); }});
      }
    }
  }
  return jobs;
}

Json merge_disturbance(const DisturbancePlan& plan, const std::vector<Json>& results) {
  Json rows = Json::array();
  std::span<const Json> left(results);
  for (const PushRow& row : plan.rows) {
    const std::size_t cases = static_cast<std::size_t>(row.phases) * static_cast<std::size_t>(row.seeds);
    rows.push_back(merged_row(plan, row, left.first(cases)));
    left = left.subspan(cases);
  }
  return {{"rows", std::move(rows)}};
}

}  // namespace stilt::experiments
