#include "host_tools/experiments/disturbance.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "host_tools/experiments/table_text.h"

namespace stilt::experiments {
namespace {

constexpr double kSlip_m = 0.01;

PushTrial trial_of(double force_N, const log::RunSummary& summary) {
  return {force_N,
          summary.survived,
          summary.fall_time_s,
          summary.step_length_min_m,
          summary.step_length_max_m,
          summary.slip_distance_m,
          summary.saturated_s};
}

Json to_json(const PushTrial& trial) {
  return {{"force_N", trial.force_N},
          {"survived", trial.survived},
          {"fall_time_s", trial.survived ? Json(nullptr) : Json(trial.fall_time_s)},
          {"step_length_min_m", trial.step_length_min_m},
          {"step_length_max_m", trial.step_length_max_m},
          {"slip_m", trial.slip_m},
          {"saturated_s", trial.saturated_s}};
}

Json run_job(const DisturbancePlan& plan, const DisturbancePlan::Row& row, int phase, int seed,
             const WalkRunner& run) {
  WalkCase walk;
  walk.controller = row.controller;
  walk.horizon_s = row.horizon_s;
  walk.command.speed_m_s = plan.speed_m_s;
  walk.seed = static_cast<std::uint64_t>(seed);
  walk.push_start_s = push_start_s(plan, row, phase);
  walk.push_duration_s = plan.push_duration_s;
  walk.duration_s = walk.push_start_s + plan.push_duration_s + plan.recovery_s;
  const PushLimit limit = find_push_limit(plan.search, [&](double force_N) {
    walk.push_N = force_N;
    return trial_of(force_N, run(walk).summary);
  });
  Json trials = Json::array();
  for (const PushTrial& trial : limit.trials) trials.push_back(to_json(trial));
  return {{"controller", row.controller},
          {"horizon_s", row.horizon_s},
          {"phase", phase},
          {"seed", seed},
          {"limit_N", limit.force_N ? Json(*limit.force_N) : Json(nullptr)},
          {"trials", std::move(trials)}};
}

/// Published largest push; nothing where the paper shows none.
std::optional<double> paper_N(const DisturbancePlan::Row& row) {
  static const std::map<std::pair<std::string, int>, double> kPaper = {
      {{"mpc-lumped", 20}, 2.0},    {{"mpc-none", 20}, 22.0}, {{"mpc-heuristic", 20}, 22.0},
      {{"mpc-heuristic", 5}, 22.0}, {{"mpc-hzd", 20}, 22.0},  {{"mpc-hzd", 5}, 22.0},
      {{"mpc-hzd", 2}, 20.0}};
  if (row.controller == "hzd-pd") return 30.0;
  const auto found = kPaper.find({row.controller, static_cast<int>(std::lround(10.0 * row.horizon_s))});
  return found == kPaper.end() ? std::nullopt : std::optional(found->second);
}

/// What the survived runs of a row have in common.
class RowFigures {
 public:
  void add(const Json& result) {
    limits_.push_back(result.at("limit_N").is_null() ? -1.0 : result.at("limit_N").get<double>());
    const double unpushed_m = result.at("trials").at(0).at("slip_m").get<double>();
    for (const Json& trial : result.at("trials")) {
      if (trial.at("survived").get<bool>()) add_survived(trial, unpushed_m);
    }
  }

  [[nodiscard]] Json row(const DisturbancePlan::Row& row) {
    std::sort(limits_.begin(), limits_.end());
    const auto limit = [](double value) { return value < 0.0 ? Json(nullptr) : Json(value); };
    const auto published = paper_N(row);
    const auto walks = std::count_if(limits_.begin(), limits_.end(), [](double v) { return v >= 0.0; });
    Json all = Json::array();
    for (const double value : limits_) all.push_back(limit(value));
    return {{"controller", row.controller},
            {"horizon_s", row.controller == "hzd-pd" ? Json(nullptr) : Json(row.horizon_s)},
            {"push_all_phases_N", limit(limits_.front())},
            {"push_half_phases_N", limit(limits_[limits_.size() / 2])},
            {"paper_N", published ? Json(*published) : Json(nullptr)},
            {"step_length_range_m", step_max_m_ >= step_min_m_ ? Json(step_max_m_ - step_min_m_) : Json()},
            {"step_length_min_m", step_max_m_ >= step_min_m_ ? Json(step_min_m_) : Json()},
            {"step_length_max_m", step_max_m_ >= step_min_m_ ? Json(step_max_m_) : Json()},
            {"first_slip_N", first_slip_N_ ? Json(*first_slip_N_) : Json(nullptr)},
            {"saturated_s", saturated_s_},
            {"cases", limits_.size()},
            {"walks", walks},
            {"limits_N", std::move(all)}};
  }

 private:
  void add_survived(const Json& trial, double unpushed_m) {
    step_min_m_ = std::min(step_min_m_, trial.at("step_length_min_m").get<double>());
    step_max_m_ = std::max(step_max_m_, trial.at("step_length_max_m").get<double>());
    saturated_s_ = std::max(saturated_s_, trial.at("saturated_s").get<double>());
    const double force_N = trial.at("force_N").get<double>();
    if (trial.at("slip_m").get<double>() < unpushed_m + kSlip_m) return;
    first_slip_N_ = std::min(first_slip_N_.value_or(force_N), force_N);
  }

  std::vector<double> limits_;
  double step_min_m_ = 1e9, step_max_m_ = -1e9;
  double saturated_s_ = 0.0;
  std::optional<double> first_slip_N_;
};

}  // namespace

std::vector<DisturbancePlan::Row> published_rows() {
  std::vector<DisturbancePlan::Row> rows;
  for (const double horizon_s : {2.0, 0.5, 0.2}) {
    for (const char* controller : {"mpc-lumped", "mpc-none", "mpc-heuristic", "mpc-hzd"}) {
      rows.push_back({controller, horizon_s});
    }
  }
  rows.push_back({"hzd-pd", 0.5});
  return rows;
}

double push_start_s(const DisturbancePlan& plan, const DisturbancePlan::Row& row, int phase) {
  constexpr double kFirstLiftOff_s = 0.3;
  const double steps = std::ceil((plan.settled_s - kFirstLiftOff_s) / row.step_s - 1e-9);
  const double share = phase % 2 + static_cast<double>(phase) / plan.phases;
  return kFirstLiftOff_s + row.step_s * (steps + share);
}

std::vector<Job> disturbance_jobs(const DisturbancePlan& plan, const WalkRunner& run) {
  std::vector<Job> jobs;
  for (const DisturbancePlan::Row& row : plan.rows) {
    for (int phase = 0; phase < plan.phases; ++phase) {
      for (int seed = 1; seed <= plan.seeds; ++seed) {
        const std::string id = row.controller + "_" + text("%.2f", row.horizon_s) + "s_phase" +
                               std::to_string(phase) + "of" + std::to_string(plan.phases) + "_seed" +
                               std::to_string(seed);
        jobs.push_back({id, [=] { return run_job(plan, row, phase, seed, run); }});
      }
    }
  }
  return jobs;
}

Json merge_disturbance(const DisturbancePlan& plan, const std::vector<Json>& results) {
  Json rows = Json::array();
  const std::size_t cases = static_cast<std::size_t>(plan.phases) * static_cast<std::size_t>(plan.seeds);
  for (std::size_t i = 0; i < plan.rows.size(); ++i) {
    RowFigures figures;
    for (std::size_t k = 0; k < cases; ++k) figures.add(results.at(i * cases + k));
    rows.push_back(figures.row(plan.rows[i]));
  }
  return {{"rows", std::move(rows)}};
}

std::string disturbance_table(const Json& merged) {
  std::string table =
      "| controller | horizon s | all phases N | half of them N | paper N | step lengths m | first slip N | "
      "saturated s | walks unpushed |\n|---|---|---|---|---|---|---|---|---|\n";
  for (const Json& row : merged.at("rows")) {
    std::string steps = "-";
    if (!row.at("step_length_range_m").is_null()) {
      steps = cell(row.at("step_length_range_m"), "%.2f", "") + " (" +
              cell(row.at("step_length_min_m"), "%.2f", "") + " to " +
              cell(row.at("step_length_max_m"), "%.2f", "") + ")";
    }
    table += "| " + row.at("controller").get<std::string>() + " | " + cell(row.at("horizon_s"), "%.1f", "-") +
             " | " + cell(row.at("push_all_phases_N"), "%.0f", "falls unpushed") + " | " +
             cell(row.at("push_half_phases_N"), "%.0f", "falls unpushed") + " | " +
             cell(row.at("paper_N"), "%.0f", "-") + " | " + steps + " | " +
             cell(row.at("first_slip_N"), "%.0f", "none") + " | " + cell(row.at("saturated_s"), "%.2f", "-") +
             " | " + std::to_string(row.at("walks").get<int>()) + " of " +
             std::to_string(row.at("cases").get<int>()) + " |\n";
  }
  return table;
}

}  // namespace stilt::experiments
