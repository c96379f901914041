#include "host_tools/cli/record_command.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string>
#include <system_error>

#include "host_tools/cli/check_duration.h"
#include "host_tools/cli/json_output.h"
#include "host_tools/cli/network_options.h"
#include "host_tools/cli/progress.h"
#include "host_tools/cli/usage_error.h"
#include "host_tools/recording/mcap/output_file.h"
#include "host_tools/recording/record/recorder.h"
#include "host_tools/telemetry/listener.h"

namespace stilt::cli {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

constexpr std::chrono::milliseconds kFlushEvery{500};
constexpr std::chrono::milliseconds kWait{100};
/// Samples of a topic that are kept while a busy machine delays this program.
constexpr int kKeeps = 8192;

std::atomic<bool> ended = false;
static_assert(std::atomic<bool>::is_always_lock_free);

void end(int) { ended.store(true); }

void catch_signals() {
  struct sigaction action{};
  action.sa_handler = end;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

std::int64_t time_of_day_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

record::Recorder::Options recorder_options(const RecordOptions& options) {
  record::Recorder::Options how;
  how.compression = mcap::compression_named(options.compression == "none" ? "" : options.compression);
  if (how.compression == mcap::Compression::lz4) how.level = 0;
  return how;
}

/// Records until the duration is over or the program is to end.
void record_all(const RecordOptions& options, host_telemetry::Listener& listener,
                record::Recorder& recorder) {
  const double longest_s = options.duration_s.value_or(std::numeric_limits<double>::infinity());
  std::fprintf(stderr, "recording to %s; end it with Ctrl-C\n", options.out_file.c_str());
  Progress progress("recording", longest_s, "s");
  const Clock::time_point start = Clock::now();
  Clock::time_point flushed = start;
  double elapsed_s = 0.0;
  while (!ended.load() && elapsed_s < longest_s) {
    static_cast<void>(listener.wait(kWait));
    listener.take([&](telemetry::Sample&& sample) { recorder.take(sample, time_of_day_ns()); });
    const Clock::time_point now = Clock::now();
    if (now - flushed >= kFlushEvery) {
      recorder.flush();
      flushed = now;
    }
    elapsed_s = std::chrono::duration<double>(now - start).count();
    progress.update(elapsed_s);
  }
  recorder.close();
}

/// A record of nothing is no use, and would be in the way of the next one of its name.
void remove_record(const std::string& file) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(file, ignored)) std::filesystem::remove(file, ignored);
}

bool whole(const record::Recorder& recorder) {
  const auto& runs = recorder.runs();
  return !runs.empty() && recorder.problem().empty() &&
         std::ranges::all_of(runs, [](const auto& run) { return run.second.gaps().empty(); });
}

/// Why an empty record is no use; its file is removed.
std::string nothing_received(const telemetry::Network& network) {
  return "nothing was received on domain " + std::to_string(network.domain) + ", interface " +
         network.interface + ", and no file is left; does stiltd run there, with telemetry.enabled?";
}

/// How a record ended.
struct Ending {
  double elapsed_s = 0.0;
  std::uint64_t bytes = 0;  ///< of the file that is left
  std::string problem;      ///< why it ended early, or is no use; empty when neither
};

Json to_json(const record::Recorder& recorder, const Ending& ending) {
  const std::string& problem = ending.problem;
  Json json;
  json["duration_s"] = ending.elapsed_s;
  json["messages"] = recorder.messages();
  json["bytes"] = ending.bytes;
  json["complete"] = problem.empty() && whole(recorder);
  json["problem"] = problem.empty() ? Json(nullptr) : Json(problem);
  json["runs"] = Json::array();
  for (const auto& [run_id, ledger] : recorder.runs()) {
    Json missing = Json::array();
    for (const record::TickLedger::Gap& gap : ledger.gaps()) missing.push_back({gap.first, gap.end - 1});
    json["runs"].push_back({{"run_id", run_id}, {"ticks", ledger.count()}, {"missing", missing}});
  }
  return json;
}

void print(const RecordOptions& options, const record::Recorder& recorder, const Ending& ending) {
  std::printf("%s: %llu messages in %.1f s, %.2f MB\n", options.out_file.c_str(),
              static_cast<unsigned long long>(recorder.messages()), ending.elapsed_s,
              1e-6 * static_cast<double>(ending.bytes));
  for (const auto& [run_id, ledger] : recorder.runs()) {
    std::printf("run %016llx: %s\n", static_cast<unsigned long long>(run_id), ledger.text().c_str());
  }
}

}  // namespace

CLI::App* add_record_command(CLI::App& program, RecordOptions& options) {
  CLI::App* record = program.add_subcommand("record", "record all telemetry of the robot to an MCAP file");
  record->add_option("--out", options.out_file, "file to write")->required();
  record->add_option("--duration", options.duration_s, "duration, s; default: until Ctrl-C");
  record->add_option("--compression", options.compression, "zstd, lz4 or none")
      ->check(CLI::IsMember({"zstd", "lz4", "none"}))
      ->capture_default_str();
  add_network_options(*record, options.network);
  record->add_option("--json", options.json_file, "writes the results as JSON; - is standard output");
  record->footer(
      "Start it before or soon after stiltd: it gets the last six seconds of ticks when it comes later, and "
      "stilt "
      "replay\nneeds them from the first one on.\n"
      "Exit status: 0 done, 1 nothing was received, ticks are missing or stiltd is of another release, 2 bad "
      "usage.");
  return record;
}

int run_record(const RecordOptions& options) {
  check_duration(options.duration_s);
  if (options.out_file == "-") throw UsageError("--out -: a record is no text; name a file");
  check_output_files({{"--out", options.out_file}, {"--json", options.json_file}});
  mcap::OutputFile::require_new(options.out_file);
  const telemetry::Participant participant = host_telemetry::join(options.network);
  host_telemetry::Listener listener(participant, record::Recorder::topics(), kKeeps);
  record::Recorder recorder(options.out_file, recorder_options(options));
  catch_signals();
  const Clock::time_point start = Clock::now();
  std::string failure;  // to write
  try {
    record_all(options, listener, recorder);
  } catch (const std::runtime_error& error) {
    failure = error.what();
  }
  Ending ending{0.0, recorder.bytes(), recorder.problem()};
  if (failure.empty() && recorder.messages() == 0) {
    remove_record(options.out_file);
    ending = {0.0, 0, nothing_received(options.network)};
  }
  ending.elapsed_s = std::chrono::duration<double>(Clock::now() - start).count();
  if (options.json_file != "-") print(options, recorder, ending);
  if (!ending.problem.empty()) {
    std::fprintf(stderr, "stilt: %s: %s\n", options.out_file.c_str(), ending.problem.c_str());
  }
  if (!failure.empty()) ending.problem = failure;
  write_each({[&] {
                if (!options.json_file.empty()) write_json(to_json(recorder, ending), options.json_file);
              },
              [&] {
                if (!failure.empty()) throw UsageError(failure);
              }});
  return whole(recorder) ? 0 : 1;
}

}  // namespace stilt::cli
