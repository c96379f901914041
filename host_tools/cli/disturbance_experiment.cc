#include "host_tools/cli/disturbance_experiment.h"

#include <algorithm>
#include <map>

#include "host_tools/cli/experiment_jobs.h"
#include "host_tools/cli/experiment_rows.h"
#include "host_tools/cli/json_output.h"
#include "host_tools/cli/usage_error.h"
#include "host_tools/experiments/disturbance.h"
#include "host_tools/simulation/closed_loop/scenario.h"
#include "host_tools/simulation/plant/number.h"

namespace stilt::cli {
namespace {

using experiments::DisturbancePlan;
using experiments::Json;
using experiments::PublishedRow;
using experiments::PushRow;

constexpr double kUsualHorizon_s = 1.0;
constexpr int kUsualSeeds = 3;

/// The options that apply to every row.
RowChoice defaults_of(const ExperimentOptions& options) {
  RowChoice row;
  row.setting = options.setting;
  row.gait = options.gait;
  row.speed_m_s = options.speed_m_s;
  row.direction = options.direction;
  row.phases = options.phases;
  row.seeds = options.seeds.value_or(kUsualSeeds);
  row.coarse_N = options.coarse_N;
  return row;
}

/// The published rows selected by --controller and --horizon. For horizons that are not published: those
/// controllers at these horizons; all predictive ones when none is named.
std::vector<PublishedRow> chosen_rows(const ExperimentOptions& options) {
  const auto among = [](const auto& list, const auto& value) {
    return list.empty() || std::ranges::find(list, value) != list.end();
  };
  const auto any_horizon = [](const PublishedRow& row) { return row.controller == "hzd-pd"; };
  for (const std::string& controller : options.controllers) check_controller(controller);
  std::vector<PublishedRow> rows;
  for (const PublishedRow& row : experiments::published_rows()) {
    if (!among(options.controllers, row.controller)) continue;
    if (any_horizon(row) || among(options.horizons_s, row.horizon_s)) rows.push_back(row);
  }
  const std::vector<std::string> controllers =
      options.controllers.empty() ? experiments::HorizonPlan{}.controllers : options.controllers;
  for (const double horizon_s : options.horizons_s) {
    for (const std::string& controller : controllers) {
      const auto same = [&](const PublishedRow& row) {
        return row.controller == controller && (any_horizon(row) || row.horizon_s == horizon_s);
      };
      if (std::ranges::none_of(rows, same)) rows.push_back({controller, horizon_s});
    }
  }
  return rows;
}

std::vector<RowChoice> rows_of_options(const ExperimentOptions& options) {
  std::vector<RowChoice> rows;
  for (const auto& [controller, horizon_s] : chosen_rows(options)) {
    RowChoice row = defaults_of(options);
    row.setting = setting_for(options.setting, controller);
    row.setting.choice.controller = controller;
    row.setting.choice.horizon_s = horizon_s;
    row.name =
        controller == "hzd-pd" ? controller : controller + "_" + simulation::decimals_text(horizon_s) + "s";
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<RowChoice> rows_of(ExperimentOptions options) {
  constexpr double kHorizonOfQuick_s = 0.5;
  if (options.rows_file.empty()) {
    if (options.quick && options.horizons_s.empty()) options.horizons_s = {kHorizonOfQuick_s};
    return rows_of_options(options);
  }
  if (!options.controllers.empty() || !options.horizons_s.empty()) {
    throw UsageError("--rows " + options.rows_file +
                     ": its rows name controller and horizon; leave --controller and --horizon out");
  }
  return read_rows(options.rows_file, defaults_of(options));
}

/// The settings that a row depends on besides its own fields.
Json setting_json(const WalkSetting& setting, const control::TimingParameters& timing) {
  Json json = {{"push_at", setting.push_point},       {"plan_rate_hz", timing.plan_rate_hz},
               {"plan_delay_s", timing.plan_delay_s}, {"state", setting.state},
               {"preset", setting.choice.preset},     {"set", setting.choice.settings},
               {"plant", setting.plant_settings}};
  if (!setting.choice.gait_folder.empty()) json["gaits"] = setting.choice.gait_folder;
  if (setting.choice.controller == "mpc-lumped") json["lump"] = setting.choice.lump;
  return json;
}

PushRow push_row(const RowChoice& choice) {
  const std::string& controller = choice.setting.choice.controller;
  PushRow row;
  row.name = choice.name;
  row.robot = choice.setting.choice.robot;
  row.controller = controller;
  row.horizon_s = choice.setting.choice.horizon_s.value_or(kUsualHorizon_s);
  row.command = {simulation::parse_gait(choice.gait), choice.speed_m_s};
  row.backward = choice.direction == "backward";
  row.phases = choice.phases;
  row.seeds = choice.seeds;
  row.search.coarse_N = choice.coarse_N;
  row.step_time_s = walk_step_time_s(choice.setting, controller, row.horizon_s);
  row.setting =
      setting_json(choice.setting, walk_parameters(choice.setting, controller, row.horizon_s).timing);
  row.walk = walk_runner(choice.setting);
  return row;
}

/// The settings that the results of a row depend on, except phases and seeds, which are in the names of the
/// jobs.
std::string dependencies_of(const RowChoice& choice) {
  const WalkSetting& setting = choice.setting;
  const double horizon_s = setting.choice.horizon_s.value_or(kUsualHorizon_s);
  return dependencies_text(setting, setting.choice.controller, horizon_s) + choice.gait + "\n" +
         simulation::number_text(choice.speed_m_s) + "\n" + choice.direction + "\n" +
         simulation::number_text(choice.coarse_N) + "\n";
}

/// Shortens the experiment to a quick check that it runs.
void cut_to_quick(DisturbancePlan& plan) {
  plan.recovery_s = 3.0;
  for (PushRow& row : plan.rows) {
    row.phases = 2;
    row.seeds = 1;
    row.search = {20.0, 20.0, 40.0};
  }
}

}  // namespace

void add_disturbance_options(CLI::App& command, ExperimentOptions& options) {
  command.add_option(
      "--rows", options.rows_file,
      "TOML file of tables [[row]]: name and any of robot, controller, horizon_s, preset, set, plant, "
      "gaits, lump, push_at, direction, gait, speed_m_s, plan_rate_hz, plan_delay_s, state, "
      "phases, seeds, coarse_N; other options are the defaults of the rows");
  command.add_option("--phases", options.phases, "number of phases of the step at which the push begins")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command.add_option("--coarse", options.coarse_N, "coarse step of the forces to try, N")
      ->check(CLI::Range(1.0, 100.0))
      ->capture_default_str();
  command.add_option("--gait", options.gait, "gait during the push: walk, step, stand")
      ->check(CLI::IsMember({"walk", "step", "stand"}))
      ->capture_default_str();
  command.add_option("--speed", options.speed_m_s, "walking speed, m/s, negative backward")
      ->check(CLI::Range(-kLargestRowSpeed_m_s, kLargestRowSpeed_m_s))
      ->capture_default_str();
  command.add_option("--direction", options.direction, "direction of the push: forward, backward")
      ->check(CLI::IsMember({"forward", "backward"}))
      ->capture_default_str();
  command.add_option("--push-at", options.setting.push_point, "point of the push: hip or torso")
      ->capture_default_str();
  command.add_option("--plan-rate", options.setting.choice.plan_rate_hz,
                     "plans per second, Hz, rounded as by stilt sim; default 500");
  command.add_option("--plan-delay", options.setting.choice.plan_delay_s,
                     "simulated time that a plan takes, s, rounded as by stilt sim; default 0.002");
  command
      .add_option(
          "--state", options.setting.state,
          "state that the controller gets: estimated (from sensors) or truth (all but the base's velocity)")
      ->capture_default_str();
}

experiments::DisturbancePlan disturbance_plan(const ExperimentOptions& options) {
  DisturbancePlan plan;
  for (const RowChoice& choice : rows_of(options)) plan.rows.push_back(push_row(choice));
  if (options.quick) cut_to_quick(plan);
  return plan;
}

int run_disturbance(const ExperimentOptions& options, const std::vector<std::string>& arguments) {
  (void)walk_runner(options.setting);  // reports errors of the settings before anything runs
  const DisturbancePlan plan = disturbance_plan(options);
  std::map<std::string, std::string> parts;
  std::vector<std::string> inputs;
  for (const RowChoice& choice : rows_of(options)) {
    parts.emplace(choice.name, dependencies_of(choice));
    const std::vector<std::string> files = files_read(choice.setting.choice);
    inputs.insert(inputs.end(), files.begin(), files.end());
  }
  check_output_files({{"--json", options.json_file}}, inputs);
  return run_jobs(
      options, arguments, settings_json(options, "disturbance", parts), disturbance_jobs(plan),
      [&](const std::vector<Json>& results) { return merge_disturbance(plan, results); },
      experiments::disturbance_table);
}

}  // namespace stilt::cli
