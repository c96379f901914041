#include "host_tools/experiments/shortest_horizon.h"

#include <algorithm>
#include <cstdint>
#include <span>

#include "host_tools/experiments/table_text.h"
#include "host_tools/experiments/walks.h"
#include "host_tools/simulation/plant/number.h"

namespace stilt::experiments {
namespace {

Json run_job(const HorizonPlan& plan, const std::string& controller, double horizon_s, int seed,
             const WalkRunner& run) {
  WalkCase walk;
  walk.controller = controller;
  walk.horizon_s = horizon_s;
  walk.seed = static_cast<std::uint64_t>(seed);
  walk.command = plan.command;
  walk.duration_s = plan.duration_s;
  const log::RunSummary summary = run(walk).summary;
  return {{"controller", controller},
          {"horizon_s", horizon_s},
          {"seed", seed},
          {"survived", summary.survived},
          {"fall_time_s", summary.survived ? Json(nullptr) : Json(summary.fall_time_s)},
          {"mean_speed_m_s", summary.mean_speed_m_s},
          {"walks", walks(plan.command, summary)}};
}

/// Summary over the seeds of one horizon.
Json tried_horizon(std::span<const Json> seeds) {
  bool all_walk = true;
  int survivors = 0;
  double speeds_m_s = 0.0;
  Json fall_time_s = nullptr;
  for (const Json& result : seeds) {
    all_walk = all_walk && result.at("walks").get<bool>();
    if (result.at("survived").get<bool>()) {
      ++survivors;
      speeds_m_s += result.at("mean_speed_m_s").get<double>();
    } else if (fall_time_s.is_null() || result.at("fall_time_s") < fall_time_s) {
      fall_time_s = result.at("fall_time_s");
    }
  }
  return {{"horizon_s", seeds.front().at("horizon_s")},
          {"survived", survivors == static_cast<int>(seeds.size())},
          {"fall_time_s", std::move(fall_time_s)},
          {"mean_speed_m_s", survivors > 0 ? Json(speeds_m_s / survivors) : Json(nullptr)},
          {"walks", all_walk}};
}

/// Reasons why tried horizons do not count: "0.25 (falls after 6.5 s), 0.35 (0.745 m/s)".
std::string failures(const Json& row) {
  std::string text;
  for (const Json& horizon : row.at("tried")) {
    if (horizon.at("walks").get<bool>()) continue;
    const std::string reason = horizon.at("survived").get<bool>()
                                   ? cell(horizon.at("mean_speed_m_s"), "%.3f m/s")
                                   : cell(horizon.at("fall_time_s"), "falls after %.1f s");
    text +=
        (text.empty() ? "" : ", ") + simulation::decimals_text(horizon.at("horizon_s")) + " (" + reason + ")";
  }
  return text.empty() ? "none" : text;
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
      for (int seed = 1; seed <= plan.seeds; ++seed) {
        jobs.push_back(
            {controller + "_" + simulation::decimals_text(horizon_s) + "s_seed" + std::to_string(seed),
             [=] { return run_job(plan, controller, horizon_s, seed, run); }});
      }
    }
  }
  return jobs;
}

Json merge_horizons(const HorizonPlan& plan, const std::vector<Json>& results) {
  Json rows = Json::array();
  const auto seeds = static_cast<std::size_t>(plan.seeds);
  std::span<const Json> left(results);
  for (const std::string& controller : plan.controllers) {
    Json tried = Json::array();
    for (std::size_t i = 0; i < plan.horizons_s.size(); ++i) {
      tried.push_back(tried_horizon(left.first(seeds)));
      left = left.subspan(seeds);
    }
    const auto last_failure =
        std::find_if(tried.rbegin(), tried.rend(), [](const Json& h) { return !h.at("walks").get<bool>(); });
    const auto shortest = last_failure.base();
    const bool none = shortest == tried.end();
    rows.push_back({{"controller", controller},
                    {"shortest_horizon_s", none ? Json(nullptr) : shortest->at("horizon_s")},
                    {"mean_speed_m_s", none ? Json(nullptr) : shortest->at("mean_speed_m_s")},
                    {"commanded_speed_m_s", plan.command.speed_m_s},
                    {"duration_s", plan.duration_s},
                    {"seeds", plan.seeds},
                    {"tried", std::move(tried)}});
  }
  return {{"rows", std::move(rows)}};
}

std::string horizon_table(const Json& merged) {
  std::string table =
      "| controller | shortest horizon s | walks there at m/s | does not walk at the command at s |\n"
      "|---|---|---|---|\n";
  for (const Json& row : merged.at("rows")) {
    const Json& shortest = row.at("shortest_horizon_s");
    table += "| " + row.at("controller").get<std::string>() + " | " +
             (shortest.is_null() ? "none" : simulation::decimals_text(shortest)) + " | " +
             cell(row.at("mean_speed_m_s"), "%.3f") + " | " + failures(row) + " |\n";
  }
  return table;
}

}  // namespace stilt::experiments
