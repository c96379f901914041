#include "host_tools/experiments/shortest_horizon.h"

#include <algorithm>
#include <cstdint>
#include <span>

#include "host_tools/experiments/steps.h"
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
  const auto settled_step_m = [&](const char* foot) {
    const auto length_m = mean_step_m(summary.steps, foot, 0.5 * plan.duration_s);
    return summary.survived && length_m ? Json(*length_m) : Json(nullptr);
  };
  return {{"controller", controller},
          {"horizon_s", horizon_s},
          {"seed", seed},
          {"survived", summary.survived},
          {"fall_time_s", summary.survived ? Json(nullptr) : Json(summary.fall_time_s)},
          {"mean_speed_m_s", summary.mean_speed_m_s},
          {"step_length_left_m", settled_step_m("L")},
          {"step_length_right_m", settled_step_m("R")},
          {"walks", walks(plan.command, summary)}};
}

/// Mean of a value over the seeds that survive; null without one.
Json mean_of_survivors(std::span<const Json> seeds, const char* key) {
  double sum = 0.0;
  int count = 0;
  for (const Json& result : seeds) {
    if (!result.at("survived").get<bool>() || result.at(key).is_null()) continue;
    sum += result.at(key).get<double>();
    ++count;
  }
  return count > 0 ? Json(sum / count) : Json(nullptr);
}

/// Summary over the seeds of one horizon.
Json tried_horizon(std::span<const Json> seeds) {
  bool all_walk = true;
  Json fall_time_s = nullptr;
  for (const Json& result : seeds) {
    all_walk = all_walk && result.at("walks").get<bool>();
    if (result.at("survived").get<bool>()) continue;
    if (fall_time_s.is_null() || result.at("fall_time_s") < fall_time_s)
      fall_time_s = result.at("fall_time_s");
  }
  return {{"horizon_s", seeds.front().at("horizon_s")},
          {"survived", fall_time_s.is_null()},
          {"fall_time_s", fall_time_s},
          {"mean_speed_m_s", mean_of_survivors(seeds, "mean_speed_m_s")},
          {"step_length_left_m", mean_of_survivors(seeds, "step_length_left_m")},
          {"step_length_right_m", mean_of_survivors(seeds, "step_length_right_m")},
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
  for (int i = 2; i <= 20; ++i) horizons_s.push_back(0.05 * i);
  horizons_s.insert(horizons_s.end(), {1.5, 2.0});
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
                    {"step_length_left_m", none ? Json(nullptr) : shortest->at("step_length_left_m")},
                    {"step_length_right_m", none ? Json(nullptr) : shortest->at("step_length_right_m")},
                    {"commanded_speed_m_s", plan.command.speed_m_s},
                    {"duration_s", plan.duration_s},
                    {"seeds", plan.seeds},
                    {"tried", std::move(tried)}});
  }
  return {{"rows", std::move(rows)}};
}

std::string horizon_table(const Json& merged) {
  std::string table =
      "| controller | shortest horizon s | walks there at m/s | with steps left, right m | does not walk at "
      "the "
      "command at s |\n"
      "|---|---|---|---|---|\n";
  for (const Json& row : merged.at("rows")) {
    const Json& shortest = row.at("shortest_horizon_s");
    table += "| " + row.at("controller").get<std::string>() + " | " +
             (shortest.is_null() ? "none" : simulation::decimals_text(shortest)) + " | " +
             cell(row.at("mean_speed_m_s"), "%.3f") + " | " + cell(row.at("step_length_left_m"), "%.3f") +
             ", " + cell(row.at("step_length_right_m"), "%.3f") + " | " + failures(row) + " |\n";
  }
  return table;
}

}  // namespace stilt::experiments
