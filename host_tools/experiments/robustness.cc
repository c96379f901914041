#include "host_tools/experiments/robustness.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host_tools/experiments/correlation.h"
#include "host_tools/experiments/table_text.h"

namespace stilt::experiments {
namespace {

Json run_job(const RobustnessPlan& plan, int run, const WalkRunner& walk_runner) {
  const WalkCase walk = random_walk(plan, run);
  const log::RunSummary summary = walk_runner(walk).summary;
  const std::uint32_t seed = robot_seed(plan.seed, run);
  const std::vector<double> values = drawn_values(plan.quantities, seed);
  Json changes = Json::object();
  for (std::size_t i = 0; i < values.size(); ++i) changes[plan.quantities[i].name] = values[i];
  return {{"run", run},
          {"seed", seed},
          {"survived", summary.survived},
          {"fall_time_s", summary.survived ? Json(nullptr) : Json(summary.fall_time_s)},
          {"fall_margin_min", summary.fall_margin_min},
          {"mean_speed_m_s", summary.mean_speed_m_s},
          {"changes", std::move(changes)},
          {"command", plan.command(walk)}};
}

Json quantity_json(const RandomQuantity& quantity, const std::vector<Json>& results) {
  std::vector<double> values, distances, falls, outcomes;
  for (const Json& result : results) {
    values.push_back(value_of(quantity.name, result));
    distances.push_back(std::abs(values.back() - quantity.nominal.value_or(0.0)));
    falls.push_back(result.at("survived").get<bool>() ? 0.0 : 1.0);
    outcomes.push_back(outcome(result));
  }
  const bool between_ends =
      quantity.nominal && *quantity.nominal > quantity.low && *quantity.nominal < quantity.high;
  return {{"name", quantity.name},
          {"words", quantity.words},
          {"unit", quantity.unit},
          {"low", quantity.low},
          {"high", quantity.high},
          {"nominal", quantity.nominal ? Json(*quantity.nominal) : Json(nullptr)},
          {"falls", to_json(correlation(values, falls))},
          {"margin", to_json(rank_correlation(values, outcomes))},
          {"distance", between_ends ? to_json(rank_correlation(distances, outcomes)) : Json(nullptr)}};
}

/// The larger of a quantity's two correlations with the outcome, without its sign.
double strength(const Json& quantity) {
  double largest = 0.0;
  for (const char* kind : {"margin", "distance"}) {
    if (quantity.at(kind).is_null()) continue;
    largest = std::max(largest, std::abs(quantity.at(kind).at("value").get<double>()));
  }
  return largest;
}

std::string correlation_text(const Json& estimate) {
  return estimate.is_null() ? "-" : estimate_text(estimate, "%.2f");
}

}  // namespace

WalkCase random_walk(const RobustnessPlan& plan, int run) {
  const std::uint32_t seed = robot_seed(plan.seed, run);
  WalkCase walk;
  walk.controller = plan.controller;
  walk.horizon_s = plan.horizon_s;
  walk.command.speed_m_s = plan.speed_m_s;
  walk.push_N = plan.force_N;
  walk.seed = seed;
  apply_values(plan.quantities, drawn_values(plan.quantities, seed), plan.timing, walk);
  return walk;
}

std::string run_name(const RobustnessPlan& plan, int run) {
  char number[16];
  (void)std::snprintf(number, sizeof number, "%04d", run);
  return "seed" + std::to_string(plan.seed) + "_run" + number;
}

std::vector<Job> robustness_jobs(const RobustnessPlan& plan, const WalkRunner& walk_runner) {
  std::vector<Job> jobs;
  for (int run = 0; run < plan.runs; ++run) {
    jobs.push_back({run_name(plan, run), [=] { return run_job(plan, run, walk_runner); }});
  }
  return jobs;
}

double value_of(const std::string& quantity, const Json& result) {
  const Json& changes = result.at("changes");
  if (quantity == "slope_as_read_rad") {
    return changes.at("ground_slope_rad").get<double>() - changes.at("base_pitch_bias_rad").get<double>();
  }
  return changes.at(quantity).get<double>();
}

double outcome(const Json& result) {
  constexpr double kLongerThanAnyRun_s = 1e6;
  return result.at("survived").get<bool>() ? result.at("fall_margin_min").get<double>()
                                           : result.at("fall_time_s").get<double>() - kLongerThanAnyRun_s;
}

Json merge_robustness(const RobustnessPlan& plan, const std::vector<Json>& results) {
  const auto survived =
      std::ranges::count_if(results, [](const Json& one) { return one.at("survived").get<bool>(); });
  std::vector<Json> quantities;
  for (const auto& list : {plan.quantities, combined_quantities()}) {
    for (const RandomQuantity& quantity : list) quantities.push_back(quantity_json(quantity, results));
  }
  std::ranges::stable_sort(quantities, {}, [](const Json& quantity) { return -strength(quantity); });
  std::vector<Json> worst = results;
  std::ranges::stable_sort(worst, {}, outcome);
  worst.resize(std::min(worst.size(), static_cast<std::size_t>(plan.worst)));
  for (Json& one : worst) one["page"] = run_name(plan, one.at("run").get<int>()) + ".html";
  return {{"controller", plan.controller},
          {"horizon_s", plan.horizon_s},
          {"speed_m_s", plan.speed_m_s},
          {"force_N", plan.force_N},
          {"seed", plan.seed},
          {"runs", plan.runs},
          {"survived", survived},
          {"survival", to_json(share(static_cast<int>(survived), plan.runs))},
          {"quantities", quantities},
          {"worst", worst}};
}

std::string robustness_table(const Json& merged) {
  const Json& survival = merged.at("survival");
  std::string table =
      cell(merged.at("survived"), "%.0f") + " of " + cell(merged.at("runs"), "%.0f") +
      " random robots stay on their feet: " + text("%.1f", 100.0 * survival.at("value").get<double>()) +
      " % (" + text("%.1f", 100.0 * survival.at("low").get<double>()) + " to " +
      text("%.1f", 100.0 * survival.at("high").get<double>()) +
      " %, Wilson's interval, 95 %)\n\n"
      "| quantity | low | high | correlation with falling | with the margin | of its distance "
      "from nominal with the margin |\n|---|---|---|---|---|---|\n";
  for (const Json& one : merged.at("quantities")) {
    table += "| " + one.at("name").get<std::string>() + " | " + cell(one.at("low"), "%g") + " | " +
             cell(one.at("high"), "%g") + " | " + correlation_text(one.at("falls")) + " | " +
             correlation_text(one.at("margin")) + " | " + correlation_text(one.at("distance")) + " |\n";
  }
  table += "\n| worst run | seed | falls at s | smallest margin |\n|---|---|---|---|\n";
  for (const Json& one : merged.at("worst")) {
    table += "| " + cell(one.at("run"), "%.0f") + " | " + cell(one.at("seed"), "%.0f") + " | " +
             cell(one.at("fall_time_s"), "%.2f") + " | " + cell(one.at("fall_margin_min"), "%.2f") + " |\n";
  }
  return table;
}

}  // namespace stilt::experiments
