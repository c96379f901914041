#include "host_tools/cli/limits_experiment.h"

#include <algorithm>

#include "host_tools/cli/experiment_jobs.h"
#include "host_tools/cli/usage_error.h"
#include "host_tools/experiments/blind_limits.h"

namespace stilt::cli {
namespace {

using experiments::BlindQuantity;
using experiments::Json;
using experiments::LimitPlan;

constexpr const char* kCommands = "commands";  ///< the name of the random sequences for --quantity

/// Keeps the quantities selected by --quantity.
void choose_quantities(const std::vector<std::string>& chosen, LimitPlan& plan) {
  if (chosen.empty()) return;
  std::vector<BlindQuantity> left;
  for (const std::string& name : chosen) {
    if (name == kCommands) continue;
    const auto found = std::ranges::find(plan.quantities, name, &BlindQuantity::name);
    if (found == plan.quantities.end()) {
      throw UsageError("--quantity " + name +
                       ": no such quantity; stilt experiment limits --help lists them");
    }
    left.push_back(*found);
  }
  plan.quantities = left;
  if (std::ranges::find(chosen, kCommands) == chosen.end()) plan.sequences = 0;
}

}  // namespace

LimitPlan limit_plan(const ExperimentOptions& options) {
  LimitPlan plan;
  plan.phases = options.quick ? 1 : options.phases;
  plan.seeds = options.quick ? 1 : options.seeds.value_or(plan.seeds);
  choose_quantities(options.quantities, plan);
  if (options.quick) {
    for (BlindQuantity& quantity : plan.quantities) {
      quantity.search.coarse *= 2.0;
      quantity.search.fine = quantity.search.coarse;
    }
    plan.duration_s = 8.0;
    plan.sequences = std::min(plan.sequences, 1);
    plan.sequence_s = 10.0;
  }
  const auto controllers =
      options.controllers.empty() ? std::vector<std::string>{"mpc-heuristic"} : options.controllers;
  const auto horizons_s = options.horizons_s.empty() ? std::vector<double>{1.0} : options.horizons_s;
  plan.controllers.clear();
  for (const std::string& controller : controllers) {
    for (const double horizon_s : horizons_s) {
      const WalkSetting setting = setting_for(options.setting, controller);
      plan.controllers.push_back({controller, horizon_s, walk_step_time_s(setting, controller, horizon_s)});
    }
  }
  return plan;
}

void add_limit_options(CLI::App& command, ExperimentOptions& options) {
  command
      .add_option("--phases", options.phases, "number of phases of the gait step at which the ground steps")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command
      .add_option(
          "--quantity", options.quantities,
          "only this quantity: step_up, step_down, slope_up, slope_down, speed_forward, speed_backward, "
          "friction, mass_up, mass_down, plan_delay, torque_delay, commands; repeatable")
      ->allow_extra_args(false);
}

int run_limits(const ExperimentOptions& options, const std::vector<std::string>& arguments) {
  const LimitPlan plan = limit_plan(options);
  std::vector<std::string> controllers;
  for (const LimitPlan::Controller& controller : plan.controllers) controllers.push_back(controller.name);
  const auto jobs = experiments::limit_jobs(plan, runner_for_each(options.setting));
  return run_jobs(
      options, arguments, settings_json(options, "limits", parts_of(options.setting, controllers)), jobs,
      [&](const std::vector<Json>& results) { return merge_limits(plan, results); },
      experiments::limit_table);
}

}  // namespace stilt::cli
