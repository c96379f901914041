#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "firmware/diagnostics/standard_streams.h"
#include "firmware/program/usage_text.h"
#include "host_tools/cli/bench_command.h"
#include "host_tools/cli/config_command.h"
#include "host_tools/cli/examples.h"
#include "host_tools/cli/experiment_command.h"
#include "host_tools/cli/gait_command.h"
#include "host_tools/cli/log_command.h"
#include "host_tools/cli/model_evaluation.h"
#include "host_tools/cli/monitor_command.h"
#include "host_tools/cli/record_command.h"
#include "host_tools/cli/replay_command.h"
#include "host_tools/cli/report_command.h"
#include "host_tools/cli/robot_command.h"
#include "host_tools/cli/sim_command.h"
#include "host_tools/cli/version.h"

namespace {

constexpr int kBadUsage = 2;

std::string joined(int argc, char** argv) {
  std::string text = "stilt";
  for (int i = 1; i < argc; ++i) text += std::string(" ") + argv[i];
  return text;
}

/// Prints one sentence on standard error. Returns exit status 2.
int refuse(std::string message) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::cerr << "stilt: " << message << '\n';
  return kBadUsage;
}

/// The words after the program's name. `stilt help sim` is `stilt sim --help`, `stilt version` is `stilt
/// --version`.
std::vector<std::string> arguments(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && words.front() == "help") {
    words.erase(words.begin());
    words.emplace_back("--help");
  } else if (words == std::vector<std::string>{"version"}) {
    words = {"--version"};
  }
  return words;
}

/// The words of `stilt help` up to the first that is no command; empty when all are.
std::string no_command(const CLI::App& program, int argc, char** argv) {
  if (argc < 2 || argv[1] != std::string("help")) return "";
  const CLI::App* command = &program;
  std::string words;
  for (int i = 2; i < argc && argv[i][0] != '-'; ++i) {
    const std::string word = argv[i];
    words += (words.empty() ? "" : " ") + word;
    const auto named =
        command->get_subcommands([&](const CLI::App* inner) { return inner->get_name() == word; });
    if (named.empty()) return words;
    command = named.front();
  }
  return "";
}

int run(int argc, char** argv) {
  CLI::App program{"Onboard whole-body predictive controller for planar walking robots.", "stilt"};
  program.footer("`stilt help COMMAND` or `stilt COMMAND --help` lists the options of a command.");
  program.set_version_flag("-v,--version", stilt::cli::version_text());
  program.require_subcommand(1);

  stilt::cli::SimOptions sim_options;
  const CLI::App* sim = stilt::cli::add_sim_command(program, sim_options);
  stilt::cli::BenchOptions bench_options;
  const CLI::App* bench = stilt::cli::add_bench_command(program, bench_options);
  stilt::cli::RobotOptions robot_options;
  const CLI::App* robot = stilt::cli::add_robot_command(program, robot_options);
  stilt::cli::GaitOptions gait_options;
  const CLI::App* gait = stilt::cli::add_gait_command(program, gait_options);
  stilt::cli::RecordOptions record_options;
  const CLI::App* record = stilt::cli::add_record_command(program, record_options);
  stilt::cli::MonitorOptions monitor_options;
  const CLI::App* monitor = stilt::cli::add_monitor_command(program, monitor_options);
  stilt::cli::ReplayOptions replay_options;
  const CLI::App* replay = stilt::cli::add_replay_command(program, replay_options);
  stilt::cli::ExperimentOptions experiment_options;
  const CLI::App* experiment = stilt::cli::add_experiment_command(program, experiment_options);
  stilt::cli::ConfigOptions config_options;
  const CLI::App* config = stilt::cli::add_config_command(program, config_options);
  stilt::cli::LogOptions log_options;
  const CLI::App* log = stilt::cli::add_log_command(program, log_options);
  stilt::cli::ReportOptions report_options;
  const CLI::App* report = stilt::cli::add_report_command(program, report_options);
  CLI::App* model = program.add_subcommand("model", "the robot's generated dynamics");
  model->require_subcommand(1);
  CLI::App* eval = model->add_subcommand("eval",
                                         "reads {\"x\": [14], \"u\": [8]} per line from standard input, "
                                         "writes all terms as JSON, one line each");
  std::string model_robot = "amber3m";
  eval->add_option("--robot", model_robot, stilt::cli::robot_help())->capture_default_str();

  stilt::cli::add_examples(program);
  if (const std::string words = no_command(program, argc, argv); !words.empty()) {
    return refuse("help: " + words + " is no command; see stilt --help");
  }
  try {
    stilt::program::parse(program, arguments(argc, argv));
  } catch (const CLI::Success& help_or_version) {
    return program.exit(help_or_version);
  } catch (const CLI::ParseError& error) {
    return refuse(stilt::program::usage_text(program, error));
  }
  if (sim->parsed()) return stilt::cli::run_sim(sim_options, joined(argc, argv));
  if (robot->parsed()) return stilt::cli::run_robot(robot_options, joined(argc, argv));
  if (monitor->parsed()) return stilt::cli::run_monitor(monitor_options);
  if (gait->parsed()) return stilt::cli::run_gait(*gait, gait_options);
  if (record->parsed()) return stilt::cli::run_record(record_options);
  if (config->parsed()) return stilt::cli::run_config(config_options);
  if (log->parsed()) return stilt::cli::run_log(log_options);
  if (report->parsed()) return stilt::cli::run_report(report_options);
  if (replay->parsed()) return stilt::cli::run_replay(replay_options);
  if (experiment->parsed())
    return stilt::cli::run_experiment(*experiment, experiment_options, {argv, argv + argc});
  if (bench->parsed()) return stilt::cli::run_bench(bench_options);
  stilt::cli::evaluate_lines(stilt::cli::robot_model(model_robot), std::cin, std::cout);
  return std::ferror(stdin) == 0 ? 0 : refuse("standard input cannot be read to its end");
}

}  // namespace

int main(int argc, char** argv) {
  if (!stilt::diagnostics::keep_standard_streams()) return kBadUsage;
  try {
    const int status = run(argc, argv);
    return stilt::diagnostics::all_printed() ? status : refuse(stilt::diagnostics::kNotPrinted);
  } catch (const std::exception& error) {
    return refuse(error.what());
  }
}
