#pragma once

#include <string>

#include "host_tools/log/run_record.h"
#include "host_tools/simulator/plant.h"

namespace stilt::cli {

/// The summary of a run for people, a few lines.
[[nodiscard]] std::string summary_text(const log::RunSummary& summary, simulator::Fall fall);

}  // namespace stilt::cli
