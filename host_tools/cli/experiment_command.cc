#include "host_tools/cli/experiment_command.h"

#include <algorithm>
#include <cstdio>

#include "host_tools/cli/disturbance_experiment.h"
#include "host_tools/cli/experiment_jobs.h"
#include "host_tools/cli/frequency_experiment.h"
#include "host_tools/cli/friction_experiment.h"
#include "host_tools/cli/json_output.h"
#include "host_tools/cli/limits_experiment.h"
#include "host_tools/cli/paired_experiment.h"
#include "host_tools/cli/published_command.h"
#include "host_tools/cli/robustness_experiment.h"
#include "host_tools/cli/speeds_experiment.h"
#include "host_tools/experiments/figures.h"

namespace stilt::cli {
namespace {

using experiments::Json;

void add_common_options(CLI::App& command, ExperimentOptions& options) {
  command.add_option("--out", options.folder, "folder for the results, created when absent")->required();
  command.add_option("--json", options.json_file,
                     "writes the results as JSON to a file, or - for standard output");
  command.add_flag("--quick", options.quick, "runs a small part of the experiment, as a check");
  command.add_option("--robot", options.setting.choice.robot, robot_help())->capture_default_str();
  command.add_option("--config", options.setting.choice.config_file,
                     "controller configuration (TOML) instead of the shipped one");
  add_preset_option(command, options.setting.choice.preset);
  command
      .add_option("--set", options.setting.choice.settings,
                  "changes one key of the configuration: section.key=value; repeatable")
      ->allow_extra_args(false);
  command
      .add_option("--plant", options.setting.plant_settings,
                  "changes the simulated robot or its world: KEY=VALUE; repeatable")
      ->allow_extra_args(false);
  command.add_option("--gaits", options.setting.choice.gait_folder,
                     "folder of gait files instead of the shipped ones, for mpc-hzd and hzd-pd");
  command.add_option("--lump", options.setting.choice.lump, "what mpc-lumped neglects: legs, drives, law")
      ->capture_default_str();
}

void add_job_options(CLI::App& command, ExperimentOptions& options) {
  command.add_flag("--list-jobs", options.list_jobs, "prints the names of the jobs and runs none");
  command.add_option("--job", options.job, "runs only this job, unless it has a result");
  command.add_flag("--merge", options.merge, "runs no job, merges the results");
  command.add_option("--processes", options.at_once, "jobs at a time; all cores by default")
      ->check(CLI::Range(1, 1024));
}

/// Options that choose among the jobs of an experiment.
void add_choice_options(CLI::App& command, ExperimentOptions& options, const char* seeds_text) {
  command.add_option("--controller", options.controllers, "only this controller; repeatable")
      ->allow_extra_args(false);
  command.add_option("--horizon", options.horizons_s, "only this horizon, s; repeatable")
      ->allow_extra_args(false);
  command.add_option("--seeds", options.seeds, seeds_text)->check(CLI::Range(1, 1000));
}

int run_horizons(const ExperimentOptions& options, const std::vector<std::string>& arguments) {
  const experiments::HorizonPlan plan = horizon_plan(options);
  for (const std::string& controller : plan.controllers) {
    for (const double horizon_s : plan.horizons_s) {
      (void)walk_parameters(setting_for(options.setting, controller), controller, horizon_s);
    }
  }
  const auto jobs = experiments::horizon_jobs(plan, runner_for_each(options.setting));
  return run_jobs(
      options, arguments, settings_json(options, "horizon", parts_of(options.setting, plan.controllers)),
      jobs, [&](const std::vector<Json>& results) { return merge_horizons(plan, results); },
      experiments::horizon_table);
}

int run_figures(const ExperimentOptions& options) {
  constexpr double kDuration_s = 34.0;
  constexpr double kQuickDuration_s = 12.0;
  const Json settings =
      settings_json(options, "figures", parts_of(options.setting, {"mpc-heuristic", "mpc-hzd"}));
  const experiments::JobFolder folder(options.folder, settings);
  const std::string page = checked_file(options, "figures.html");
  experiments::FiguresResult figures = experiments::make_figures(
      runner_for_each(options.setting), options.quick ? kQuickDuration_s : kDuration_s);
  figures.numbers["command"] = options.command;
  figures.numbers["settings"] = settings;
  folder.keep("figures", figures.numbers);
  write_output_file("--out", page, figures.page);
  if (!options.json_file.empty()) write_json(figures.numbers, options.json_file);
  if (options.json_file != "-") std::puts(page.c_str());
  return 0;
}

}  // namespace

experiments::HorizonPlan horizon_plan(const ExperimentOptions& options) {
  experiments::HorizonPlan plan;
  plan.horizons_s = experiments::tried_horizons_s();
  if (options.quick) {
    plan.horizons_s = {0.2, 0.5};
    plan.duration_s = 5.0;
  }
  if (!options.controllers.empty()) plan.controllers = options.controllers;
  if (!options.horizons_s.empty()) plan.horizons_s = options.horizons_s;
  std::ranges::sort(plan.horizons_s);
  plan.seeds = options.seeds.value_or(plan.seeds);
  return plan;
}

void add_walk_options(CLI::App& command, ExperimentOptions& options) {
  command.add_option("--controller", options.setting.choice.controller, "controller, as for stilt sim")
      ->capture_default_str();
  command.add_option("--horizon", options.setting.choice.horizon_s, "horizon of the planner, s; default 1.0");
}

CLI::App* add_experiment_command(CLI::App& program, ExperimentOptions& options) {
  CLI::App* experiment = program.add_subcommand("experiment", "the published experiments, with figures");
  experiment->require_subcommand(1);
  CLI::App* frequency = experiment->add_subcommand(
      "frequency", "plans per second at horizons of 2.0, 1.0, 0.5 and 0.2 s, ten iterations, one thread");
  add_common_options(*frequency, options);
  frequency->add_option("--problems", options.problems, "planning problems of a walk to solve")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  CLI::App* disturbance = experiment->add_subcommand(
      "disturbance",
      "largest push of 1 s survived, five controllers walking at 0.5 m/s or the rows of a file");
  add_common_options(*disturbance, options);
  add_job_options(*disturbance, options);
  add_choice_options(*disturbance, options, "of the sensor noise, default 3");
  add_disturbance_options(*disturbance, options);
  CLI::App* horizon = experiment->add_subcommand(
      "horizon", "shortest horizon that walks 60 s at 0.5 m/s, for every predictive controller");
  add_common_options(*horizon, options);
  add_job_options(*horizon, options);
  add_choice_options(*horizon, options,
                     "seeds of the sensor noise, default 1; a horizon counts when all of them walk");
  CLI::App* speeds =
      experiment->add_subcommand("speeds", "mean speed of a minute at commanded speeds, after its first 3 s");
  add_common_options(*speeds, options);
  add_job_options(*speeds, options);
  add_speed_options(*speeds, options);
  CLI::App* limits = experiment->add_subcommand("limits",
                                                "changes of ground, speed, friction, mass and delays that "
                                                "the robot survives unannounced, and random commands");
  add_common_options(*limits, options);
  add_job_options(*limits, options);
  add_choice_options(*limits, options, "of the sensor noise, default 3");
  add_limit_options(*limits, options);
  CLI::App* robustness = experiment->add_subcommand(
      "robustness",
      "random robots in random worlds under a push: how many stay on their feet, and what goes with falls: "
      "robustness.html");
  add_common_options(*robustness, options);
  add_job_options(*robustness, options);
  add_robustness_options(*robustness, options);
  CLI::App* paired = experiment->add_subcommand("paired",
                                                "the same pushes with more plans per second, the true state "
                                                "and feedback gains: whether fewer are survived");
  add_common_options(*paired, options);
  add_job_options(*paired, options);
  add_paired_options(*paired, options);
  CLI::App* friction = experiment->add_subcommand(
      "friction", "position error of joints with Coulomb friction that the controller knows or not");
  add_common_options(*friction, options);
  add_job_options(*friction, options);
  add_friction_options(*friction, options);
  CLI::App* figures = experiment->add_subcommand(
      "figures",
      "a push over time, postures, joint angles and their repeatability, terminal states: figures.html");
  add_common_options(*figures, options);
  return experiment;
}

int run_experiment(const CLI::App& experiment, ExperimentOptions options,
                   const std::vector<std::string>& arguments) {
  check_output_folder(options.folder);
  const ControllerChoice& choice = options.setting.choice;
  std::vector<std::string> inputs = files_read(choice);
  inputs.push_back(options.rows_file);
  check_output_files({{"--json", options.json_file}}, inputs);
  options.command = published_command(arguments);
  if (options.quick && options.job.empty()) {
    std::fputs("quick: few cases in coarse steps, so figures differ from docs/results.md\n", stderr);
  }
  if (experiment.got_subcommand("frequency")) return run_frequency(options);
  if (experiment.got_subcommand("horizon")) return run_horizons(options, arguments);
  if (experiment.got_subcommand("speeds")) return run_speeds(options, arguments);
  if (experiment.got_subcommand("limits")) return run_limits(options, arguments);
  if (experiment.got_subcommand("robustness")) return run_robustness(options, arguments);
  if (experiment.got_subcommand("paired")) return run_paired(options, arguments);
  if (experiment.got_subcommand("friction")) return run_friction(options, arguments);
  if (experiment.got_subcommand("figures")) return run_figures(options);
  return run_disturbance(options, arguments);
}

}  // namespace stilt::cli
