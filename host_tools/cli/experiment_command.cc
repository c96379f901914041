#include "host_tools/cli/experiment_command.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "host_tools/cli/experiment_jobs.h"
#include "host_tools/cli/frequency_experiment.h"
#include "host_tools/cli/json_output.h"
#include "host_tools/cli/usage_error.h"
#include "host_tools/experiments/disturbance.h"
#include "host_tools/experiments/figures.h"
#include "host_tools/experiments/shortest_horizon.h"

namespace stilt::cli {
namespace {

using experiments::DisturbancePlan;
using experiments::Json;

constexpr double kHorizonOfQuick_s = 0.5;

void add_common_options(CLI::App& command, ExperimentOptions& options) {
  command.add_option("--out", options.folder, "folder for the results, made when there is none")->required();
  command.add_option("--json", options.json_file,
                     "writes the figures as JSON to a file, or - for standard output");
  command.add_flag("--quick", options.quick, "a small part of it, to see that it works");
  command.add_option("--robot", options.setting.choice.robot, "robot: amber3m, amber3m_2020, rabbit")
      ->capture_default_str();
  command.add_option("--config", options.setting.choice.config_file,
                     "controller configuration (TOML) instead of the shipped one");
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

void add_job_options(CLI::App& command, ExperimentOptions& options, const char* seeds_text) {
  command.add_flag("--list-jobs", options.list_jobs, "prints the names of the jobs and runs none");
  command.add_option("--job", options.job, "runs this job alone, unless it has a result");
  command.add_flag("--merge", options.merge, "runs no job, merges the results");
  command.add_option("--processes", options.at_once, "jobs at a time; all cores unless told otherwise")
      ->check(CLI::Range(1, 1024));
  command.add_option("--controller", options.controllers, "only this controller; repeatable")
      ->allow_extra_args(false);
  command.add_option("--horizon", options.horizons_s, "only this horizon, s; repeatable")
      ->allow_extra_args(false);
  command.add_option("--seeds", options.seeds, seeds_text)->check(CLI::Range(1, 1000));
}

void add_disturbance(CLI::App& experiment, ExperimentOptions& options) {
  CLI::App* command = experiment.add_subcommand(
      "disturbance", "largest forward push of 1 s survived while walking at 0.5 m/s, five controllers");
  add_common_options(*command, options);
  add_job_options(*command, options, "of the sensor noise, default 3");
  command->add_option("--phases", options.phases, "of the step, at which the push begins")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->add_option("--coarse", options.coarse_N, "every multiple of this force is tried, N")
      ->check(CLI::Range(1.0, 100.0))
      ->capture_default_str();
  command->add_option("--push-at", options.setting.push_point, "hip or torso")->capture_default_str();
}

/// The setting without what does not concern a controller: --gaits is refused by those that follow none.
WalkSetting setting_for(const WalkSetting& setting, const std::string& controller) {
  WalkSetting own = setting;
  if (controller != "mpc-hzd" && controller != "hzd-pd") own.choice.gait_folder.clear();
  return own;
}

experiments::WalkRunner runner_for_each(const WalkSetting& setting) {
  (void)walk_runner(setting);  // mistakes are told before anything runs
  return [setting](const experiments::WalkCase& walk) {
    return walk_runner(setting_for(setting, walk.controller))(walk);
  };
}

bool chosen(const ExperimentOptions& options, const DisturbancePlan::Row& row) {
  const auto among = [](const auto& list, const auto& value) {
    return list.empty() || std::ranges::find(list, value) != list.end();
  };
  const bool once = row.controller == "hzd-pd";
  return among(options.controllers, row.controller) && (once || among(options.horizons_s, row.horizon_s));
}

/// The rows that --controller and --horizon leave, or, for horizons that are not published, those controllers
/// at these horizons.
std::vector<DisturbancePlan::Row> rows_of(const ExperimentOptions& options) {
  std::vector<DisturbancePlan::Row> rows;
  for (const DisturbancePlan::Row& row : experiments::published_rows()) {
    if (chosen(options, row)) rows.push_back(row);
  }
  for (const double horizon_s : options.horizons_s) {
    for (const std::string& controller : options.controllers) {
      const auto same = [&](const DisturbancePlan::Row& row) {
        return row.controller == controller && (controller == "hzd-pd" || row.horizon_s == horizon_s);
      };
      if (std::ranges::none_of(rows, same)) rows.push_back({controller, horizon_s});
    }
  }
  if (rows.empty()) {
    throw UsageError("--controller " + options.controllers.front() +
                     ": no such controller; known are mpc-none, mpc-heuristic, mpc-hzd, mpc-lumped, hzd-pd");
  }
  return rows;
}

DisturbancePlan disturbance_plan(ExperimentOptions& options) {
  DisturbancePlan plan;
  if (options.quick) {
    options.horizons_s = {kHorizonOfQuick_s};
    options.phases = 2;
    options.seeds = 1;
    plan.search = {40.0, 20.0, 80.0};
    plan.recovery_s = 2.0;
  } else {
    plan.search.coarse_N = options.coarse_N;
  }
  plan.rows = rows_of(options);
  plan.phases = options.phases;
  plan.seeds = options.seeds.value_or(plan.seeds);
  for (DisturbancePlan::Row& row : plan.rows) {
    const control::ControllerParameters parameters =
        walk_parameters(setting_for(options.setting, row.controller), row.controller, row.horizon_s);
    row.step_s = parameters.gait.single_support_s + parameters.gait.double_support_s;
  }
  return plan;
}

int run_disturbance(ExperimentOptions& options, const std::vector<std::string>& words) {
  const DisturbancePlan plan = disturbance_plan(options);
  Json settings = settings_json(options, "disturbance");
  settings["coarse_N"] = plan.search.coarse_N;
  const auto jobs = experiments::disturbance_jobs(plan, runner_for_each(options.setting));
  return run_jobs(
      options, words, settings, jobs,
      [&](const std::vector<Json>& results) { return merge_disturbance(plan, results); },
      experiments::disturbance_table);
}

int run_horizons(const ExperimentOptions& options, const std::vector<std::string>& words) {
  experiments::HorizonPlan plan;
  plan.horizons_s = experiments::tried_horizons_s();
  if (options.quick) {
    plan.horizons_s = {0.2, kHorizonOfQuick_s};
    plan.duration_s = 5.0;
  }
  if (!options.controllers.empty()) plan.controllers = options.controllers;
  if (!options.horizons_s.empty()) plan.horizons_s = options.horizons_s;
  std::ranges::sort(plan.horizons_s);
  for (const std::string& controller : plan.controllers) {
    for (const double horizon_s : plan.horizons_s) {
      (void)walk_parameters(setting_for(options.setting, controller), controller, horizon_s);
    }
  }
  plan.seeds = options.seeds.value_or(plan.seeds);
  const auto jobs = experiments::horizon_jobs(plan, runner_for_each(options.setting));
  return run_jobs(
      options, words, settings_json(options, "horizon"), jobs,
      [&](const std::vector<Json>& results) { return merge_horizons(plan, results); },
      experiments::horizon_table);
}

int run_figures(const ExperimentOptions& options) {
  constexpr double kDuration_s = 34.0;
  constexpr double kQuickDuration_s = 8.0;
  const experiments::JobFolder folder(options.folder, settings_json(options, "figures"));
  const experiments::Figures figures = experiments::make_figures(
      runner_for_each(options.setting), options.quick ? kQuickDuration_s : kDuration_s);
  folder.keep("figures", figures.numbers);
  const std::filesystem::path page = std::filesystem::path(options.folder) / "figures.html";
  if (!(std::ofstream(page) << figures.page << std::flush)) {
    throw UsageError("--out " + options.folder + ": figures.html cannot be written; name a writable folder");
  }
  if (!options.json_file.empty()) write_json(figures.numbers, options.json_file);
  if (options.json_file != "-") std::puts(page.c_str());
  return 0;
}

}  // namespace

CLI::App* add_experiment_command(CLI::App& program, ExperimentOptions& options) {
  CLI::App* experiment = program.add_subcommand("experiment", "the published experiments, with figures");
  experiment->require_subcommand(1);
  CLI::App* frequency = experiment->add_subcommand(
      "frequency", "plans a second at horizons of 2.0, 1.0, 0.5 and 0.2 s, ten iterations, one thread");
  add_common_options(*frequency, options);
  frequency->add_option("--problems", options.problems, "planning problems of a walk to solve")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  add_disturbance(*experiment, options);
  CLI::App* horizon = experiment->add_subcommand(
      "horizon", "shortest horizon that walks 60 s at 0.5 m/s, for every predictive controller");
  add_common_options(*horizon, options);
  add_job_options(*horizon, options, "of the sensor noise, default 1; a horizon walks when all of them walk");
  CLI::App* figures = experiment->add_subcommand(
      "figures",
      "a push over time, postures, joint angles and how they repeat, terminal states: figures.html");
  add_common_options(*figures, options);
  return experiment;
}

int run_experiment(const CLI::App& experiment, ExperimentOptions options,
                   const std::vector<std::string>& words) {
  check_output_file("--json", options.json_file);
  if (experiment.got_subcommand("frequency")) return run_frequency(options);
  if (experiment.got_subcommand("horizon")) return run_horizons(options, words);
  if (experiment.got_subcommand("figures")) return run_figures(options);
  return run_disturbance(options, words);
}

}  // namespace stilt::cli
