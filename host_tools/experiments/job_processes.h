#pragma once

#include <functional>
#include <string>
#include <vector>

namespace stilt::experiments {

/// Runs `command` followed by "--job" and an id, for every id, in separate processes, at most `at_once` at a
/// time. Calls `finished` with the number of finished jobs. Throws std::runtime_error, one sentence, when a
/// process cannot start or fails, after the running ones have ended.
void run_in_processes(const std::vector<std::string>& command, const std::vector<std::string>& ids,
                      int at_once, const std::function<void(int done)>& finished);

}  // namespace stilt::experiments
