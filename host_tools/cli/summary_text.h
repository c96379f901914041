#pragma once

#include <string>

#include "host_tools/recording/run_record.h"
#include "host_tools/simulation/plant/plant.h"

namespace stilt::cli {

/// What the plant shows of a run, for people.
[[nodiscard]] std::string plant_text(const log::RunSummary& summary, simulation::Fall fall);

/// The summary of a run for people, a few lines.
[[nodiscard]] std::string summary_text(const log::RunSummary& summary, simulation::Fall fall);

}  // namespace stilt::cli
