#include "host_tools/cli/replay_command.h"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>

#include "host_tools/cli/json_output.h"
#include "host_tools/cli/progress.h"
#include "host_tools/cli/usage_error.h"
#include "host_tools/recording/record/record_version.h"
#include "host_tools/recording/replay/record_source.h"
#include "host_tools/recording/replay/replay_run.h"
#include "host_tools/web/monitor/serve.h"

namespace stilt::cli {
namespace {

using Json = nlohmann::ordered_json;
using replay::Outcome;
using replay::RecordedRun;

struct Replayed {
  const RecordedRun* run;
  Outcome outcome;
};

std::vector<Replayed> replay_all(const std::string& file, const replay::RecordContents& contents) {
  std::vector<Replayed> all;
  for (const RecordedRun& run : contents.runs) {
    if (run.ticks.empty()) continue;
    Progress progress("replaying", static_cast<double>(run.ticks.next()), "ticks");
    all.push_back({&run, replay::replay_run(file, run, [&](std::uint64_t tick) {
                     progress.update(static_cast<double>(tick));
                   })});
  }
  return all;
}

Json to_json(const Replayed& replayed) {
  const Outcome& outcome = replayed.outcome;
  Json json = {{"run_id", replayed.run->number}, {"robot", replayed.run->robot},
               {"build", replayed.run->build},   {"reproduced", outcome.reproduced()},
               {"ticks", outcome.ticks},         {"plans", outcome.cycles},
               {"difference", nullptr},          {"problem", nullptr}};
  if (outcome.difference) {
    json["difference"] = {{"tick", outcome.difference->tick},
                          {"what", outcome.difference->what},
                          {"recorded", outcome.difference->recorded},
                          {"replayed", outcome.difference->replayed}};
  }
  if (!outcome.problem.empty()) json["problem"] = outcome.problem;
  return json;
}

void print(const Replayed& replayed) {
  const Outcome& outcome = replayed.outcome;
  std::printf("run %016llx, %s: ", static_cast<unsigned long long>(replayed.run->number),
              replayed.run->robot.c_str());
  const auto ticks = static_cast<unsigned long long>(outcome.ticks);
  const auto plans = static_cast<unsigned long long>(outcome.cycles);
  if (outcome.reproduced()) {
    std::printf("all %llu ticks and %llu plans are the same, bit for bit\n", ticks, plans);
    return;
  }
  std::printf("%llu ticks and %llu plans are the same; then %s\n", ticks, plans,
              (outcome.difference ? outcome.difference->text() : outcome.problem).c_str());
  if (outcome.difference) {
    std::printf("recorded by %s; results are the same on the same build only\n", replayed.run->build.c_str());
  }
}

std::atomic<bool> stop = false;
static_assert(std::atomic<bool>::is_always_lock_free);

/// Plays the record in the page until it is stopped.
int show(const ReplayOptions& options) {
  if (!options.json_file.empty()) {
    throw UsageError("--json " + options.json_file +
                     ": a page has no results; leave --json or --monitor out");
  }
  replay::RecordSource source(options.file);
  for (const std::string& problem : source.problems()) std::fprintf(stderr, "stilt: %s\n", problem.c_str());
  struct sigaction action{};
  action.sa_handler = [](int) { stop.store(true); };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  monitor::ServeOptions serve;
  serve.server.port = options.port;
  serve.open_browser = !options.no_browser;
  serve.stop = &stop;
  monitor::serve(source, serve);
  return source.problems().empty() ? 0 : 1;
}

}  // namespace

CLI::App* add_replay_command(CLI::App& program, ReplayOptions& options) {
  CLI::App* command = program.add_subcommand(
      "replay", "run a record through the controller again and compare plans and torques bit for bit");
  command->add_option("FILE", options.file, "record of stilt record")->required();
  command->add_option("--json", options.json_file, "writes the result as JSON; - is standard output");
  CLI::Option* monitor =
      command->add_flag("--monitor", options.monitor, "shows it in the monitor's page instead, until Ctrl-C");
  command->add_option("--port", options.port, "port of the page; 0: any free one")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str()
      ->needs(monitor);
  command->add_flag("--no-browser", options.no_browser, "only prints the address of the page")
      ->needs(monitor);
  command->footer(
      "Exit status: 0 all is the same, 1 something differs or is missing, or the file was cut off, 2 bad "
      "usage.");
  return command;
}

int run_replay(const ReplayOptions& options) {
  if (options.monitor) return show(options);
  check_output_files({{"--json", options.json_file}}, {options.file});
  const replay::RecordContents contents = replay::read_contents(options.file);
  for (const std::string& problem : contents.problems) std::fprintf(stderr, "stilt: %s\n", problem.c_str());
  const std::vector<Replayed> all = replay_all(options.file, contents);
  if (all.empty()) throw UsageError(record::without_ticks(options.file, contents.problems));
  const bool reproduced =
      std::ranges::all_of(all, [](const Replayed& one) { return one.outcome.reproduced(); });
  if (!options.json_file.empty()) {
    Json runs = Json::array();
    for (const Replayed& one : all) runs.push_back(to_json(one));
    write_json({{"reproduced", reproduced}, {"runs", runs}, {"file_problems", contents.problems}},
               options.json_file);
  }
  if (options.json_file != "-") {
    for (const Replayed& one : all) print(one);
  }
  return reproduced && contents.problems.empty() ? 0 : 1;
}

}  // namespace stilt::cli
