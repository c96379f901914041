#include "host_tools/cli/robustness_experiment.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string_view>

#include "host_tools/cli/experiment_jobs.h"
#include "host_tools/cli/json_output.h"
#include "host_tools/experiments/robustness_page.h"
#include "host_tools/simulation/plant/number.h"
#include "host_tools/web/report/report.h"

namespace stilt::cli {
namespace {

using experiments::Json;
using experiments::RobustnessPlan;
using experiments::WalkCase;

constexpr double kUsualHorizon_s = 1.0;
constexpr int kRunsOfQuick = 20;

/// Heights of the two published torsos of AMBER-3M, that of the robot first; nothing for another robot.
std::optional<std::pair<double, double>> torso_heights_m(const std::string& robot) {
  constexpr std::array<std::string_view, 2> kPublished = {"amber3m", "amber3m_2020"};
  if (std::ranges::find(kPublished, robot) == kPublished.end()) return std::nullopt;
  const auto other = robot == kPublished[0] ? kPublished[1] : kPublished[0];
  return std::pair(robot_model(robot).constants.torso_com_height_m,
                   robot_model(std::string(other)).constants.torso_com_height_m);
}

/// Writes the page of the experiment and those of its worst runs.
void write_pages(const ExperimentOptions& options, const WalkSetting& setting, const RobustnessPlan& plan,
                 const Json& merged, const std::vector<Json>& results) {
  const std::string folder = options.folder + "/";
  const experiments::WalkRunner run = walk_runner(setting);
  for (const Json& one : merged.at("worst")) {
    WalkCase walk = experiments::random_walk(plan, one.at("run").get<int>());
    walk.keep_samples = true;
    log::RunRecord record = run(walk);
    record.command_line = plan.command(walk);
    write_output_file("--out", folder + one.at("page").get<std::string>(), report::render_report(record));
  }
  write_output_file("--out", folder + "commands.txt", experiments::commands_text(results));
  write_output_file("--out", folder + "robustness.html", experiments::robustness_page(merged, results));
}

}  // namespace

void add_robustness_options(CLI::App& command, ExperimentOptions& options) {
  command.add_option("--runs", options.runs, "number of random robots")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command
      .add_option("--seed", options.seed, "seed of all random quantities; run N of a seed is always the same")
      ->check(CLI::Range(std::uint32_t{0}, std::numeric_limits<std::uint32_t>::max()))
      ->capture_default_str();
  command
      .add_option("--force", options.force_N,
                  "push of 1 s at a random phase of the step, N, positive forward")
      ->check(CLI::Range(-1000.0, 1000.0))
      ->capture_default_str();
  command.add_option("--push-at", options.setting.push_point, "point of the push: hip or torso")
      ->capture_default_str();
  add_walk_options(command, options);
}

RobustnessPlan robustness_plan(const ExperimentOptions& options) {
  const ControllerChoice& choice = options.setting.choice;
  RobustnessPlan plan;
  plan.controller = choice.controller;
  plan.horizon_s = choice.horizon_s.value_or(kUsualHorizon_s);
  plan.force_N = options.force_N;
  plan.seed = options.seed;
  plan.runs = options.quick ? std::min(options.runs, kRunsOfQuick) : options.runs;
  const WalkSetting setting = setting_for(options.setting, plan.controller);
  plan.timing.step_time_s = walk_step_time_s(setting, plan.controller, plan.horizon_s);
  plan.quantities = experiments::random_quantities(torso_heights_m(choice.robot));
  plan.command = [setting](const WalkCase& walk) { return sim_command(setting, walk); };
  return plan;
}

int run_robustness(const ExperimentOptions& options, const std::vector<std::string>& arguments) {
  const RobustnessPlan plan = robustness_plan(options);
  const WalkSetting setting = setting_for(options.setting, plan.controller);
  const std::string dependencies = dependencies_text(setting, plan.controller, plan.horizon_s) +
                                   experiments::ranges_text(plan.quantities) +
                                   simulation::number_text(plan.force_N) + "\n";
  return run_jobs(
      options, arguments, settings_json(options, "robustness", {{plan.controller, dependencies}}),
      experiments::robustness_jobs(plan, walk_runner(setting)),
      [&](const std::vector<Json>& results) {
        Json merged = merge_robustness(plan, results);
        write_pages(options, setting, plan, merged, results);
        return merged;
      },
      experiments::robustness_table);
}

}  // namespace stilt::cli
