#pragma once

#include <string>
#include <vector>

#include "host_tools/experiments/job_folder.h"

namespace stilt::experiments {

/// The experiment as one HTML page. It has survival, the worst runs with links to their pages, and
/// margins of all runs. It has correlations, and the outcome over the quantities that correlate most.
/// `merged` and `results` as of merge_robustness().
[[nodiscard]] std::string robustness_page(const Json& merged, const std::vector<Json>& results);

/// One line per run: its name, outcome and command.
[[nodiscard]] std::string commands_text(const std::vector<Json>& results);

}  // namespace stilt::experiments
