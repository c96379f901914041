#pragma once

#include <string>

#include "host_tools/recording/run/record_run.h"

/// Runs in files of text, which do not name their robot.
namespace stilt::record {

/// Reads the samples that `stilt sim --log` or `stilt robot --log` wrote, one JSON object per line. Steps,
/// distance and speed follow from the true state and the contact forces; whether the robot fell is not known.
/// Throws std::runtime_error, one sentence, when the file has no sample.
[[nodiscard]] RecordRun run_of_samples(const std::string& path, const model::RobotConstants& robot);

/// Reads the ticks that `stiltd --black-box` or `stilt log csv` wrote (firmware/diagnostics/tick_csv.h).
/// Events are the changes of state and of faults. A run begins where number or time of the ticks falls; the
/// one with most ticks is taken. Throws std::runtime_error, one sentence, when the file
/// lacks a column that is needed or has no tick.
[[nodiscard]] RecordRun run_of_ticks(const std::string& path, const model::RobotConstants& robot);

}  // namespace stilt::record
