#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "host_tools/cli/experiment_command.h"
#include "host_tools/experiments/job_folder.h"

namespace stilt::cli {

/// Handles `--list-jobs`, `--job` and `--merge`: lists the jobs, runs one, or merges the results. Without
/// these options it runs all jobs without a result, each in its own process, and merges. `merge` computes the
/// figures from all results, `table` prints them as text. Returns the exit status.
[[nodiscard]] int run_jobs(
    const ExperimentOptions& options, const std::vector<std::string>& arguments,
    const experiments::Json& settings, const std::vector<experiments::Job>& jobs,
    const std::function<experiments::Json(const std::vector<experiments::Json>&)>& merge,
    const std::function<std::string(const experiments::Json&)>& table);

/// The file of this name in the folder of --out. Throws UsageError unless it can be written. For the time
/// before the work.
[[nodiscard]] std::string checked_file(const ExperimentOptions& options, const char* name);

/// The settings that the results of an experiment depend on, for its folder and its figures. They are version
/// and commit of this program, options, and the hash of each part's dependencies_text().
[[nodiscard]] experiments::Json settings_json(const ExperimentOptions& options, const char* experiment,
                                              const std::map<std::string, std::string>& parts);

}  // namespace stilt::cli
