#pragma once

#include <string>
#include <vector>

namespace stilt::csv {

/// Result of writing a record as tables.
struct Written {
  std::vector<std::string> files;
  std::vector<std::string> problems;  ///< of the record, one sentence each
};

/// Writes a folder of tables, one per topic: /stilt/planner becomes stilt_planner.csv, with the time of day
/// in the first column. Ticks become ticks.csv with one row per tick, as in a black box
/// (firmware/diagnostics/tick_csv.h); those of further runs become ticks_2.csv and so on. Their time_s counts
/// from tick 0, and from the first tick here only where the configuration of the run is missing. Ticks
/// missing between others are a problem per run. Messages that cannot be decoded are left out, with a problem
/// per topic. Throws std::runtime_error, one sentence, also where the folder has tables already. No table is
/// there then: they take their names at the end.
[[nodiscard]] Written record_to_csv(const std::string& record, const std::string& folder);

/// Writes only the ticks, of all runs, to one file. An earlier one stays until the new one is whole.
[[nodiscard]] Written ticks_to_csv(const std::string& record, const std::string& file);

}  // namespace stilt::csv
