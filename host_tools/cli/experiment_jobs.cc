#include "host_tools/cli/experiment_jobs.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>
#include <thread>
#include <utility>

#include "firmware/version/commit.h"
#include "host_tools/cli/json_output.h"
#include "host_tools/cli/progress.h"
#include "host_tools/cli/usage_error.h"
#include "host_tools/experiments/job_processes.h"
#include "host_tools/experiments/text_hash.h"

namespace stilt::cli {
namespace {

using experiments::Job;
using experiments::JobFolder;
using experiments::Json;

/// Jobs of one name would share a result.
void refuse_repeated(const std::vector<Job>& jobs) {
  std::set<std::string> ids;
  for (const Job& job : jobs) {
    if (ids.insert(job.id).second) continue;
    throw UsageError("job " + job.id +
                     " is there twice; give each value of --controller, --horizon and --quantity once");
  }
}

int run_one(const JobFolder& folder, const std::vector<Job>& jobs, const std::string& id) {
  const auto job = std::ranges::find(jobs, id, &Job::id);
  if (job == jobs.end()) throw UsageError("--job " + id + ": no such job; --list-jobs names them");
  if (!folder.has(id)) folder.keep(id, job->run());
  return 0;
}

Json merged_results(const ExperimentOptions& options, const std::vector<Json>& results,
                    const std::function<Json(const std::vector<Json>&)>& merge) {
  try {
    return merge(results);
  } catch (const Json::exception& error) {
    throw UsageError("--out " + options.folder + ": a result lacks a field (" + error.what() +
                     "); remove the files that are damaged and run their jobs again");
  }
}

void run_missing(const ExperimentOptions& options, std::vector<std::string> arguments,
                 const JobFolder& folder, const std::vector<Job>& jobs) {
  const std::vector<std::string> ids = folder.missing(jobs);
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  arguments.front() = "/proc/self/exe";
  Progress progress("running", static_cast<double>(ids.size()), "jobs");
  experiments::run_in_processes(arguments, ids, options.at_once.value_or(cores),
                                [&](int done) { progress.update(done); });
}

}  // namespace

Json settings_json(const ExperimentOptions& options, const char* experiment,
                   const std::map<std::string, std::string>& parts) {
  const ControllerChoice& choice = options.setting.choice;
  Json configuration = Json::object();
  for (const auto& [part, text] : parts) configuration[part] = experiments::text_hash(text);
  return {{"experiment", experiment},
          {"version", STILT_VERSION},
          {"commit", version::commit()},
          {"quick", options.quick},
          {"robot", choice.robot},
          {"config", choice.config_file},
          {"preset", choice.preset},
          {"set", choice.settings},
          {"lump", choice.lump},
          {"gaits", choice.gait_folder},
          {"plant", options.setting.plant_settings},
          {"configuration", std::move(configuration)}};
}

std::string checked_file(const ExperimentOptions& options, const char* name) {
  const std::string file = (std::filesystem::path(options.folder) / name).string();
  check_output_files({{"--json", options.json_file}, {"--out", file}});
  return file;
}

int run_jobs(const ExperimentOptions& options, const std::vector<std::string>& arguments,
             const Json& settings, const std::vector<Job>& jobs,
             const std::function<Json(const std::vector<Json>&)>& merge,
             const std::function<std::string(const Json&)>& table) {
  refuse_repeated(jobs);
  if (options.list_jobs) {
    for (const Job& job : jobs) std::puts(job.id.c_str());
    return 0;
  }
  const JobFolder folder(options.folder, settings);
  const std::string table_file = checked_file(options, "table.md");
  if (!options.job.empty()) return run_one(folder, jobs, options.job);
  if (!options.merge) run_missing(options, arguments, folder, jobs);
  Json merged = merged_results(options, folder.results(jobs), merge);
  merged["command"] = options.command;
  merged["settings"] = settings;
  if (!options.json_file.empty()) write_json(merged, options.json_file);
  const std::string text = table(merged);
  write_output_file("--out", table_file, text);
  if (options.json_file != "-") std::fputs(text.c_str(), stdout);
  return 0;
}

}  // namespace stilt::cli
