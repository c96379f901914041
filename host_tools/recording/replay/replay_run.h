#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "host_tools/recording/replay/record_file.h"
#include "host_tools/recording/replay/replay.h"

namespace stilt::replay {

/// Replays one run of a record: its configuration into planner and torque loop, its ticks and solves
/// through them. A record without the run's configuration, or with one this program refuses, is a problem
/// in the outcome. Throws std::runtime_error when the file cannot be read.
/// @param progress  gets the number of the tick now and then; may be empty
[[nodiscard]] Outcome replay_run(const std::string& path, const RunRecord& run,
                                 const std::function<void(std::uint64_t tick)>& progress = {});

}  // namespace stilt::replay
