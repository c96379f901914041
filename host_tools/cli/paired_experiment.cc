#include "host_tools/cli/paired_experiment.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host_tools/cli/experiment_jobs.h"
#include "host_tools/cli/usage_error.h"
#include "host_tools/simulation/plant/number.h"

namespace stilt::cli {
namespace {

using experiments::Json;
using experiments::PairedPlan;
using experiments::PairedPush;

constexpr double kUsualHorizon_s = 1.0;
constexpr int kCasesOfQuick = 2;
constexpr double kLargestPush_N = 1000.0;

struct Variant {
  const char* name;
  double plan_rate_hz;
  double plan_delay_s;  ///< a plan takes no longer than the time between two
  const char* state;
  bool gains;
};
constexpr Variant kVariants[] = {{"rate_100_gains_off", 100.0, 0.005, "estimated", false},
                                 {"rate_100", 100.0, 0.005, "estimated", true},
                                 {"rate_200", 200.0, 0.003, "estimated", true},
                                 {"rate_500", 500.0, 0.002, "estimated", true},
                                 {"truth", 500.0, 0.002, "truth", true}};
constexpr experiments::PairedComparison kComparisons[] = {{1, 2}, {2, 3}, {1, 3}, {3, 4}, {0, 1}};

struct Push {
  std::string name;
  double force_N;
  std::string point;
};

/// Near the limits of docs/results.md, where a difference shows.
const std::vector<std::string> kUsualPushes = {"hip:175", "hip:-147", "torso:100", "torso:-98"};

/// A push POINT:FORCE of --push. Throws UsageError, one sentence.
Push parsed_push(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string point = text.substr(0, colon);
  const auto force_N = simulation::parse_number(colon == std::string::npos ? "" : text.substr(colon + 1));
  if ((point != "hip" && point != "torso") || !force_N || std::abs(*force_N) > kLargestPush_N) {
    throw UsageError("--push " + text +
                     ": must be POINT:FORCE, hip or torso and -1000 to 1000 N, as hip:175");
  }
  return {point + "_" + simulation::number_text(*force_N) + "N", *force_N, point};
}

std::vector<Push> pushes_of(const ExperimentOptions& options) {
  std::vector<Push> pushes;
  for (const std::string& text : options.pushes.empty() ? kUsualPushes : options.pushes) {
    pushes.push_back(parsed_push(text));
    const auto same = [&](const Push& push) { return push.name == pushes.back().name; };
    if (std::ranges::count_if(pushes, same) > 1) throw UsageError("--push " + text + ": is given twice");
  }
  return pushes;
}

WalkSetting setting_of(const WalkSetting& common, const Variant& variant, const Push& push) {
  WalkSetting setting = common;
  setting.choice.plan_rate_hz = variant.plan_rate_hz;
  setting.choice.plan_delay_s = variant.plan_delay_s;
  setting.choice.gains = variant.gains;
  setting.state = variant.state;
  setting.push_point = push.point;
  return setting;
}

}  // namespace

void add_paired_options(CLI::App& command, ExperimentOptions& options) {
  command.add_option("--cases", options.cases, "random phases of the step, each with its own sensor noise")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command.add_option("--seed", options.seed, "seed of phases and noise")
      ->check(CLI::Range(std::uint32_t{0}, std::numeric_limits<std::uint32_t>::max()))
      ->capture_default_str();
  std::string usual;
  for (const std::string& push : kUsualPushes) usual += " " + push;
  command
      .add_option(
          "--push", options.pushes,
          "push of 1 s, POINT:FORCE, hip or torso and N, positive forward; repeatable; default" + usual)
      ->allow_extra_args(false);
  add_walk_options(command, options);
}

PairedPlan paired_plan(const ExperimentOptions& options) {
  PairedPlan plan;
  plan.controller = options.setting.choice.controller;
  plan.horizon_s = options.setting.choice.horizon_s.value_or(kUsualHorizon_s);
  plan.cases = options.quick ? std::min(options.cases, kCasesOfQuick) : options.cases;
  plan.seed = options.seed;
  const WalkSetting common = setting_for(options.setting, plan.controller);
  plan.step_time_s = walk_step_time_s(common, plan.controller, plan.horizon_s);
  for (const Variant& variant : kVariants) {
    plan.variants.push_back({variant.name,
                             {{"plan_rate_hz", variant.plan_rate_hz},
                              {"plan_delay_s", variant.plan_delay_s},
                              {"state", variant.state},
                              {"gains", variant.gains}}});
  }
  for (const Push& push : pushes_of(options)) {
    PairedPush paired{push.name, push.force_N, push.point, {}};
    for (const Variant& variant : kVariants) {
      paired.walk.push_back(walk_runner(setting_of(common, variant, push)));
    }
    plan.pushes.push_back(std::move(paired));
  }
  plan.comparisons.assign(std::begin(kComparisons), std::end(kComparisons));
  return plan;
}

int run_paired(const ExperimentOptions& options, const std::vector<std::string>& arguments) {
  const PairedPlan plan = paired_plan(options);
  const WalkSetting common = setting_for(options.setting, plan.controller);
  std::string dependencies;
  for (const Push& push : pushes_of(options)) {
    for (const Variant& variant : kVariants) {
      dependencies += dependencies_text(setting_of(common, variant, push), plan.controller, plan.horizon_s) +
                      simulation::number_text(push.force_N) + "\n";
    }
  }
  dependencies += std::to_string(plan.seed) + "\n";
  return run_jobs(
      options, arguments, settings_json(options, "paired", {{plan.controller, dependencies}}),
      paired_jobs(plan), [&](const std::vector<Json>& results) { return merge_paired(plan, results); },
      experiments::paired_table);
}

}  // namespace stilt::cli
