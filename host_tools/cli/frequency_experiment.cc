#include "host_tools/cli/frequency_experiment.h"

#include <cstdio>
#include <string>
#include <utility>

#include "firmware/program/instruction_sets.h"
#include "host_tools/cli/experiment_jobs.h"
#include "host_tools/cli/json_output.h"
#include "host_tools/cli/planner_timing.h"
#include "host_tools/cli/planning_problems.h"
#include "host_tools/simulation/closed_loop/run_recorder.h"

namespace stilt::cli {
namespace {

using experiments::Json;

constexpr double kSpeed_m_s = 0.5;
constexpr int kIterations = 10;
constexpr std::pair<double, double> kPaper[] = {{2.0, 270.0}, {1.0, 480.0}, {0.5, 670.0}, {0.2, 850.0}};

PlannerTimings timings_of(ControllerChoice choice, double horizon_s, bool early_stop,
                          const PlanningProblems& problems) {
  choice.horizon_s = horizon_s;
  choice.iterations = kIterations;
  choice.no_early_stop = !early_stop;
  configuration::Configuration configuration = controller_configuration(choice);
  program::choose_instruction_set(configuration);
  const auto controller = make_controller(controller_setup(choice, robot_model(choice.robot), configuration));
  return time_planner(controller->planner(), problems);
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

double rate_hz(const PlannerTimings& timings) { return 1e6 / simulation::percentile(timings.solve_us, 0.5); }

std::string table_of(const Json& merged) {
  std::string table =
      "| horizon s | nodes | plans per second, 10 iterations | with early end | iterations then | paper, "
      "several "
      "threads |\n|---|---|---|---|---|---|\n";
  for (const Json& row : merged.at("rows")) {
    char line[160];
    (void)std::snprintf(line, sizeof line, "| %.1f | %d | %.0f | %.0f | %.1f | %.0f |\n",
                        row.at("horizon_s").get<double>(), row.at("nodes").get<int>(),
                        row.at("rate_hz").get<double>(), row.at("rate_early_stop_hz").get<double>(),
                        row.at("iterations_mean").get<double>(), row.at("paper_hz").get<double>());
    table += line;
  }
  return table;
}

}  // namespace

int run_frequency(const ExperimentOptions& options) {
  constexpr double kAnyHorizon_s = 1.0;
  const ControllerChoice& choice = options.setting.choice;
  const Json settings = settings_json(
      options, "frequency",
      {{choice.controller, dependencies_text(options.setting, choice.controller, kAnyHorizon_s)}});
  const experiments::JobFolder folder(options.folder, settings);
  const std::string table_file = checked_file(options, "table.md");
  const int problems = options.quick ? 20 : options.problems;
  const PlanningProblems walk = record_walk(choice, kSpeed_m_s, problems);
  Json rows = Json::array();
  int failed = 0;
  for (const auto& [horizon_s, paper_hz] : kPaper) {
    const PlannerTimings all = timings_of(choice, horizon_s, false, walk);
    const PlannerTimings early = timings_of(choice, horizon_s, true, walk);
    failed += all.failed + early.failed;
    rows.push_back({{"horizon_s", horizon_s},
                    {"nodes", all.nodes_max},
                    {"rate_hz", rate_hz(all)},
                    {"rate_early_stop_hz", rate_hz(early)},
                    {"iterations_mean", mean(early.iterations)},
                    {"paper_hz", paper_hz},
                    {"solve_us", to_json(simulation::percentiles(all.solve_us))},
                    {"solve_early_stop_us", to_json(simulation::percentiles(early.solve_us))},
                    {"isa", all.instruction_set},
                    {"threads", 1},
                    {"problems", problems}});
  }
  const Json merged = {{"rows", std::move(rows)}, {"command", options.command}, {"settings", settings}};
  folder.keep("frequency", merged);
  const std::string table = table_of(merged);
  write_output_file("--out", table_file, table);
  if (!options.json_file.empty()) write_json(merged, options.json_file);
  if (options.json_file != "-") std::fputs(table.c_str(), stdout);
  return failed == 0 && walk.survived ? 0 : 1;
}

}  // namespace stilt::cli
