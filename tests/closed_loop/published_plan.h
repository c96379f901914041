#pragma once

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "host_tools/cli/experiment_command.h"
#include "host_tools/experiments/job_folder.h"
#include "host_tools/experiments/walk_case.h"
#include "tests/closed_loop/published_results.h"

/// What is guarded is what was measured: today's experiment of a published command, without its walks.
namespace stilt::testing_support {

/// The options of the command that made a file of docs/results; the defaults when it cannot be read.
[[nodiscard]] inline cli::ExperimentOptions published_options(const std::string& table) {
  CLI::App program;
  cli::ExperimentOptions options;
  cli::add_experiment_command(program, options);
  const std::string command = results_of(table).value("command", "");
  if (!command.empty()) program.parse(command, true);
  return options;
}

/// In place of a walk: the robot survives, and nothing is simulated.
[[nodiscard]] inline log::RunRecord no_walk(const experiments::WalkCase& /*walk*/) {
  log::RunRecord record;
  record.summary.survived = true;
  return record;
}

[[nodiscard]] inline std::vector<experiments::Json> results_without_walks(
    const std::vector<experiments::Job>& jobs) {
  std::vector<experiments::Json> results;
  results.reserve(jobs.size());
  for (const experiments::Job& job : jobs) results.push_back(job.run());
  return results;
}

/// Compares these fields of two objects.
inline void expect_published(const experiments::Json& today, const experiments::Json& published,
                             const std::vector<std::string>& fields) {
  for (const std::string& field : fields) EXPECT_EQ(published.at(field), today.at(field)) << field;
}

/// The same of two lists.
inline void expect_each_published(const experiments::Json& today, const experiments::Json& published,
                                  const std::vector<std::string>& fields) {
  ASSERT_EQ(published.size(), today.size());
  for (std::size_t i = 0; i < today.size(); ++i) {
    SCOPED_TRACE("number " + std::to_string(i));
    expect_published(today[i], published[i], fields);
  }
}

}  // namespace stilt::testing_support
