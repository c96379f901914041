#include "host_tools/cli/log_command.h"

#include <cstdio>

#include "host_tools/cli/json_output.h"
#include "host_tools/recording/csv/record_to_csv.h"

namespace stilt::cli {

CLI::App* add_log_command(CLI::App& program, LogOptions& options) {
  CLI::App* log = program.add_subcommand("log", "read a record");
  log->require_subcommand(1);
  CLI::App* csv = log->add_subcommand("csv", "write a record as comma-separated values");
  csv->add_option("FILE", options.file, "record of stilt record")->required();
  csv->add_option("--out", options.out,
                  "a folder for one table per topic; or a file ending in .csv, for the ticks only")
      ->required();
  csv->footer(
      "Exit status: 0 done, 1 the record lacks ticks, was cut off or is damaged (the rest was written), 2 "
      "bad "
      "usage.");
  return log;
}

int run_log(const LogOptions& options) {
  const bool ticks_alone = options.out.ends_with(".csv");
  if (ticks_alone) {
    check_output_files({{"--out", options.out}}, {options.file});
  } else {
    check_output_folder(options.out);
  }
  const csv::Written written = ticks_alone ? csv::ticks_to_csv(options.file, options.out)
                                           : csv::record_to_csv(options.file, options.out);
  for (const std::string& problem : written.problems) std::fprintf(stderr, "stilt: %s\n", problem.c_str());
  for (const std::string& file : written.files) std::printf("%s\n", file.c_str());
  return written.problems.empty() ? 0 : 1;
}

}  // namespace stilt::cli
