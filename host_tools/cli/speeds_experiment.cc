#include "host_tools/cli/speeds_experiment.h"

#include "host_tools/cli/experiment_jobs.h"

namespace stilt::cli {

void add_speed_options(CLI::App& command, ExperimentOptions& options) {
  add_walk_options(command, options);
  command.add_option("--speed", options.speeds_m_s, "only this speed, m/s; repeatable")
      ->allow_extra_args(false)
      ->check(CLI::Range(-10.0, 10.0));
}

experiments::SpeedPlan speed_plan(const ExperimentOptions& options) {
  constexpr double kDurationOfQuick_s = 5.0;
  experiments::SpeedPlan plan;
  plan.controller = options.setting.choice.controller;
  plan.horizon_s = options.setting.choice.horizon_s.value_or(plan.horizon_s);
  if (!options.speeds_m_s.empty()) plan.speeds_m_s = options.speeds_m_s;
  if (options.quick) plan.duration_s = kDurationOfQuick_s;
  return plan;
}

int run_speeds(const ExperimentOptions& options, const std::vector<std::string>& arguments) {
  const experiments::SpeedPlan plan = speed_plan(options);
  const WalkSetting setting = setting_for(options.setting, plan.controller);
  return run_jobs(
      options, arguments,
      settings_json(options, "speeds",
                    {{plan.controller, dependencies_text(setting, plan.controller, plan.horizon_s)}}),
      speed_jobs(plan, walk_runner(setting)), experiments::merge_speeds, experiments::speed_table);
}

}  // namespace stilt::cli
