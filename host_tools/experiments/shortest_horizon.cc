#include "host_tools/experiments/shortest_horizon.h"

#include <cstdio>

namespace stilt::experiments {
namespace {

std::string seconds(double value) {
  char text[32];
  (void)std::snprintf(text, sizeof text, "%.2f", value);
  return text;
}

Json run_job(const HorizonPlan& plan, const std::string& controller, double horizon_s,
             const WalkRunner& run) {
  WalkCase walk;
  walk.controller = controller;
  walk.horizon_s = horizon_s;
  walk.speed_m_s = plan.speed_m_s;
  walk.duration_s = plan.duration_s;
  const log::RunSummary summary = run(walk).summary;
  return {{"controller", controller},
          {"horizon_s", horizon_s},
          {"survived", summary.survived},
          {"fall_time_s", summary.survived ? Json(nullptr) : Json(summary.fall_time_s)},
          {"mean_speed_m_s", summary.mean_speed_m_s}};
}

}  // namespace

std::vector<double> tried_horizons_s() {
  std::vector<double> horizons_s;
  for (int i = 2; i <= 12; ++i) horizons_s.push_back(0.05 * i);
  horizons_s.insert(horizons_s.end(), {0.8, 1.0, 1.5, 2.0});
  return horizons_s;
}

std::vector<Job> horizon_jobs(const HorizonPlan& plan, const WalkRunner& run) {
  std::vector<Job> jobs;
  for (const std::string& controller : plan.controllers) {
    for (const double horizon_s : plan.horizons_s) {
      jobs.push_back({controller + "_" + seconds(horizon_s) + "s",
                      [=] { return run_job(plan, controller, horizon_s, run); }});
    }
  }
  return jobs;
}

Json merge_horizons(const HorizonPlan& plan, const std::vector<Json>& results) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < plan.controllers.size(); ++i) {
    Json tried = Json::array();
    Json shortest = nullptr;
    bool all_longer_walk = true;
    for (std::size_t k = plan.horizons_s.size(); k-- > 0;) {
      const Json& result = results.at(i * plan.horizons_s.size() + k);
      all_longer_walk = all_longer_walk && result.at("survived").get<bool>();
      if (all_longer_walk) shortest = result.at("horizon_s");
      tried.insert(tried.begin(), result);
    }
    rows.push_back({{"controller", plan.controllers[i]},
                    {"shortest_horizon_s", std::move(shortest)},
                    {"duration_s", plan.duration_s},
                    {"tried", std::move(tried)}});
  }
  return {{"rows", std::move(rows)}};
}

std::string horizon_table(const Json& merged) {
  std::string table = "| controller | shortest horizon s | falls at, s |\n|---|---|---|\n";
  for (const Json& row : merged.at("rows")) {
    std::string falls;
    for (const Json& result : row.at("tried")) {
      if (result.at("survived").get<bool>()) continue;
      falls += (falls.empty() ? "" : ", ") + seconds(result.at("horizon_s").get<double>()) + " (after " +
               seconds(result.at("fall_time_s").get<double>()) + ")";
    }
    const Json& shortest = row.at("shortest_horizon_s");
    table += "| " + row.at("controller").get<std::string>() + " | " +
             (shortest.is_null() ? "none" : seconds(shortest.get<double>())) + " | " +
             (falls.empty() ? "none" : falls) + " |\n";
  }
  return table;
}

}  // namespace stilt::experiments
