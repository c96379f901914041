#pragma once

#include <functional>
#include <string>
#include <vector>

namespace stilt::experiments {

/// Runs `command` followed by "--job" and an id, for every id, as processes of their own, at most `at_once`
/// at a time. `finished` gets the number that are done. Throws std::runtime_error, one sentence, when one
/// cannot be started or fails; the others under way are waited for.
void run_in_processes(const std::vector<std::string>& command, const std::vector<std::string>& ids,
                      int at_once, const std::function<void(int done)>& finished);

}  // namespace stilt::experiments
