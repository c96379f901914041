#include "host_tools/experiments/paired.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host_tools/experiments/disturbance.h"
#include "host_tools/experiments/portable_random.h"
#include "host_tools/experiments/table_text.h"

namespace stilt::experiments {
namespace {

std::string job_name(const PairedPush& push, int number) {
  char digits[16];
  (void)std::snprintf(digits, sizeof digits, "%03d", number);
  return push.name + "_case" + digits;
}

Json run_job(const PairedPlan& plan, const PairedPush& push, int number) {
  const WalkCase walk = paired_walk(plan, push, number);
  Json survived = Json::object();
  for (std::size_t i = 0; i < plan.variants.size(); ++i) {
    survived[plan.variants[i].name] = push.walk[i](walk).summary.survived;
  }
  return {{"push", push.name},
          {"case", number},
          {"start_s", walk.push_start_s},
          {"seed", walk.seed},
          {"survived", survived}};
}

bool survived(const Json& result, const PairedVariant& variant) {
  return result.at("survived").at(variant.name).get<bool>();
}

Json row_json(const PairedPlan& plan, const PairedPush& push, const std::vector<Json>& results) {
  Json counts = Json::object();
  for (const PairedVariant& variant : plan.variants) {
    counts[variant.name] = std::ranges::count_if(results, [&](const Json& result) {
      return result.at("push") == push.name && survived(result, variant);
    });
  }
  return {{"push", push.name}, {"force_N", push.force_N}, {"point", push.point}, {"survived", counts}};
}

Json comparison_json(const PairedPlan& plan, const PairedComparison& comparison,
                     const std::vector<Json>& results) {
  const PairedVariant& from = plan.variants[static_cast<std::size_t>(comparison.from)];
  const PairedVariant& to = plan.variants[static_cast<std::size_t>(comparison.to)];
  PairedCounts counts;
  for (const Json& result : results) {
    const bool before = survived(result, from), after = survived(result, to);
    ++counts.cases;
    if (before && !after) ++counts.lost;
    if (!before && after) ++counts.gained;
  }
  const Estimate change = change_of_share(counts);
  return {{"from", from.name},
          {"to", to.name},
          {"cases", counts.cases},
          {"lost", counts.lost},
          {"gained", counts.gained},
          {"change", to_json(change)},
          {"worse", change.interval.high < 0.0}};
}

}  // namespace

Estimate change_of_share(const PairedCounts& counts) {
  constexpr double kQuantile = 1.96;
  const double n = counts.cases + 2.0;
  const double p = (counts.gained + 1.0) / n, q = (counts.lost + 1.0) / n;
  const double half = kQuantile * std::sqrt((p + q - (p - q) * (p - q)) / n);
  const double value = static_cast<double>(counts.gained - counts.lost) / counts.cases;
  return {value, {p - q - half, p - q + half}};
}

WalkCase paired_walk(const PairedPlan& plan, const PairedPush& push, int number) {
  std::vector<std::uint32_t> source{plan.seed, static_cast<std::uint32_t>(number)};
  for (const char letter : push.name) source.push_back(static_cast<unsigned char>(letter));
  std::seed_seq sequence(source.begin(), source.end());
  std::mt19937 random(sequence);
  WalkCase walk;
  walk.controller = plan.controller;
  walk.horizon_s = plan.horizon_s;
  walk.command.speed_m_s = plan.speed_m_s;
  walk.push_N = push.force_N;
  walk.push_start_s = lift_off_s(plan.settled_s, plan.step_time_s, between(random, 0.0, 2.0));
  walk.push_duration_s = plan.push_duration_s;
  walk.duration_s = walk.push_start_s + plan.push_duration_s + plan.recovery_s;
  walk.seed = random();
  return walk;
}

std::vector<Job> paired_jobs(const PairedPlan& plan) {
  std::vector<Job> jobs;
  for (const PairedPush& push : plan.pushes) {
    for (int number = 0; number < plan.cases; ++number) {
      jobs.push_back({job_name(push, number), [=] { return run_job(plan, push, number); }});
    }
  }
  return jobs;
}

Json merge_paired(const PairedPlan& plan, const std::vector<Json>& results) {
  Json variants = Json::array(), rows = Json::array(), comparisons = Json::array();
  for (const PairedVariant& variant : plan.variants) {
    variants.push_back({{"name", variant.name}, {"setting", variant.setting}});
  }
  for (const PairedPush& push : plan.pushes) rows.push_back(row_json(plan, push, results));
  for (const PairedComparison& comparison : plan.comparisons) {
    comparisons.push_back(comparison_json(plan, comparison, results));
  }
  return {{"controller", plan.controller},
          {"horizon_s", plan.horizon_s},
          {"speed_m_s", plan.speed_m_s},
          {"cases", plan.cases},
          {"seed", plan.seed},
          {"variants", variants},
          {"rows", rows},
          {"comparisons", comparisons}};
}

std::string paired_table(const Json& merged) {
  std::string table = "| push |";
  std::string rule = "|---|";
  for (const Json& variant : merged.at("variants")) {
    table.append(" ").append(variant.at("name").get<std::string>()).append(" |");
    rule += "---|";
  }
  table += "\n" + rule + "\n";
  const std::string of = " of " + cell(merged.at("cases"), "%.0f");
  for (const Json& row : merged.at("rows")) {
    table += "| " + row.at("push").get<std::string>() + " |";
    for (const Json& variant : merged.at("variants")) {
      const Json& survived = row.at("survived").at(variant.at("name").get<std::string>());
      table.append(" ").append(cell(survived, "%.0f")).append(of).append(" |");
    }
    table += "\n";
  }
  table += "\n| from | to | lost | gained | change of the share | worse |\n|---|---|---|---|---|---|\n";
  for (const Json& one : merged.at("comparisons")) {
    table += "| " + one.at("from").get<std::string>() + " | " + one.at("to").get<std::string>() + " | " +
             cell(one.at("lost"), "%.0f") + " | " + cell(one.at("gained"), "%.0f") + " | " +
             estimate_text(one.at("change"), "%+.3f") + " | " + (one.at("worse").get<bool>() ? "yes" : "no") +
             " |\n";
  }
  return table;
}

}  // namespace stilt::experiments
