#pragma once

#include <functional>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/diagnostics/output_file.h"
#include "host_tools/recording/run_record.h"

namespace stilt::cli {

/// JSON object {p50, p99, max}.
[[nodiscard]] nlohmann::ordered_json to_json(const log::Percentiles& percentiles);

/// The fields that the plant alone determines: distance, speed, torque, and whether the robot fell.
[[nodiscard]] nlohmann::ordered_json plant_json(const log::RunSummary& summary);

/// The output of `stilt sim --json`, with the fields that users rely on: they are added, never renamed.
[[nodiscard]] nlohmann::ordered_json to_json(const log::RunSummary& summary);

/// The files that a command writes.
using OutputFiles = std::vector<diagnostics::NamedFile>;

/// Throws UsageError unless all of them can be written, each at its own place. `inputs` are the files that
/// the command reads: none of them may be an output. Empty names stand for none. For the start of every
/// command.
void check_output_files(const OutputFiles& outputs, const std::vector<std::string>& inputs = {});

/// Throws UsageError for "-": --out of such a command is a folder of files.
void check_output_folder(const std::string& folder);

/// Whether one of them goes to standard output, so that no text may.
[[nodiscard]] bool on_standard_output(const OutputFiles& outputs);

/// Writes the text to the file that `option` names, and says so on standard error; to standard output when
/// the path is "-". Throws UsageError when it cannot be written.
void write_output_file(const std::string& option, const std::string& path, std::string_view text);

/// The same for indented JSON of --json.
void write_json(const nlohmann::ordered_json& json, const std::string& path);

/// The samples of a run for --log; nothing when the path is empty. Throws std::runtime_error, one sentence,
/// when the file cannot be written.
void write_log(const log::RunRecord& record, const std::string& path);

/// Calls each of the writers, also after one has thrown: a file that cannot be written keeps none of the
/// others back. Throws UsageError with the sentences of those that threw.
void write_each(std::initializer_list<std::function<void()>> writers);

}  // namespace stilt::cli
