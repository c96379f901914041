#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "host_tools/recording/replay/record_file.h"
#include "host_tools/recording/replay/replay.h"

namespace stilt::replay {

/// Replays one run of a record: configures planner and control loop, and runs its ticks and solves. A
/// missing or invalid configuration is a problem in the outcome. Throws std::runtime_error when the file
/// cannot be read.
/// @param progress  called with the number of the tick from time to time; may be empty
[[nodiscard]] Outcome replay_run(const std::string& path, const RecordedRun& run,
                                 const std::function<void(std::uint64_t tick)>& progress = {});

}  // namespace stilt::replay
