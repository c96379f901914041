#include "host_tools/cli/friction_experiment.h"

#include "host_tools/cli/experiment_jobs.h"
#include "host_tools/simulation/plant/number.h"

namespace stilt::cli {

void add_friction_options(CLI::App& command, ExperimentOptions& options) {
  add_walk_options(command, options);
  command.add_option("--friction", options.friction_Nm, "Coulomb friction of every joint, Nm")
      ->check(CLI::Range(0.1, 100.0))
      ->capture_default_str();
}

experiments::FrictionPlan friction_plan(const ExperimentOptions& options) {
  constexpr double kDurationOfQuick_s = 3.0;
  experiments::FrictionPlan plan;
  plan.controller = options.setting.choice.controller;
  plan.horizon_s = options.setting.choice.horizon_s.value_or(plan.horizon_s);
  plan.friction_Nm = options.friction_Nm;
  if (options.quick) {
    plan.rates = {plan.rates.back()};
    plan.duration_s = kDurationOfQuick_s;
  }
  return plan;
}

int run_friction(const ExperimentOptions& options, const std::vector<std::string>& arguments) {
  const experiments::FrictionPlan plan = friction_plan(options);
  const WalkSetting setting = setting_for(options.setting, plan.controller);
  const std::string dependencies = dependencies_text(setting, plan.controller, plan.horizon_s) +
                                   simulation::number_text(plan.friction_Nm) + "\n";
  return run_jobs(
      options, arguments, settings_json(options, "friction", {{plan.controller, dependencies}}),
      friction_jobs(plan, walk_runner(setting)),
      [&](const std::vector<experiments::Json>& results) { return merge_friction(plan, results); },
      experiments::friction_table);
}

}  // namespace stilt::cli
