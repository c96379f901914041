#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "firmware/control_loop/cycle_record.h"
#include "firmware/control_loop/tick_record.h"
#include "firmware/telemetry/messages.h"
#include "host_tools/recording/record/tick_ledger.h"

namespace stilt::replay {

/// What a record holds of one run of stiltd, but for its ticks.
struct RunRecord {
  std::uint64_t number = 0;
  bool configured = false;  ///< its configuration is in the record, and with it what follows
  std::string robot;
  std::string configuration;          ///< TOML
  std::string build;                  ///< version, compiler, instruction set
  std::vector<std::string> tunables;  ///< keys, in the order of the values of tunings
  std::vector<control_loop::CycleRecord> cycles;
  std::map<std::uint32_t, std::vector<double>> tunings;
  record::TickLedger ticks;
};

struct RecordContents {
  std::vector<RunRecord> runs;        ///< in the order in which they are met
  std::vector<std::string> problems;  ///< of the file, a sentence each
};

/// Reads all of a record but the ticks. Throws std::runtime_error, one sentence, when the file is no record.
[[nodiscard]] RecordContents read_contents(const std::string& path);

/// Gives the ticks of a run to `use`, in order and each once, until it returns false. Throws as above.
void for_each_tick(const std::string& path, std::uint64_t run_id,
                   const std::function<bool(const control_loop::TickRecord&)>& use);

}  // namespace stilt::replay
