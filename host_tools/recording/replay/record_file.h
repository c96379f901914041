#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/configuration/configuration.h"
#include "firmware/control_loop/cycle_record.h"
#include "firmware/control_loop/tick_record.h"
#include "firmware/telemetry/messages.h"
#include "host_tools/recording/record/tick_ledger.h"

namespace stilt::replay {

/// Content of a record for one run of stiltd, without its ticks.
struct RecordedRun {
  std::uint64_t number = 0;
  bool configured = false;         ///< whether the record has its configuration and the fields below
  std::string why_not_configured;  ///< when it is not: one clause
  /// The message with the configuration is damaged, and what stilt record attached took its place: without
  /// start and keys of the tunables.
  bool attached = false;
  std::int64_t start_clock_ns = 0;  ///< clock of the ticks at tick 0
  std::string robot;
  std::string urdf;                   ///< text of its description
  std::string configuration;          ///< TOML
  std::string build;                  ///< version, compiler, instruction set
  std::vector<std::string> tunables;  ///< keys, in the order of the values of tunings
  std::vector<control_loop::CycleRecord> cycles;
  std::map<std::uint32_t, std::vector<double>> tunings;
  record::TickLedger ticks;
};

/// Content of a record without its ticks.
struct RecordContents {
  std::vector<RecordedRun> runs;      ///< in the order of the record
  std::vector<std::string> problems;  ///< of the file, one sentence each
};

/// Reads a record without its ticks. Throws std::runtime_error, one sentence, when the file is not a record,
/// or has messages of another wire version.
[[nodiscard]] RecordContents read_contents(const std::string& path);

/// Names the configuration of a record in messages.
constexpr std::string_view kRecordedConfiguration = "the recorded configuration";

/// The configuration of a run, its keys under the names of this release (configuration::migrate()). One
/// sentence when this program refuses it.
[[nodiscard]] std::expected<configuration::Configuration, std::string> configuration_of(
    const RecordedRun& run);

/// Passes the ticks of a run to `use`, in order and each once, until it returns false. Throws like
/// read_contents().
void for_each_tick(const std::string& path, std::uint64_t run_id,
                   const std::function<bool(const control_loop::TickRecord&)>& use);

}  // namespace stilt::replay
