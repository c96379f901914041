#pragma once

#include <string>

#include "host_tools/recording/run_record.h"
#include "host_tools/simulation/plant/plant.h"

namespace stilt::cli {

/// The plant's part of a run's summary as text.
[[nodiscard]] std::string plant_text(const log::RunSummary& summary, simulation::Fall fall);

/// The summary of a run as a few lines of text.
[[nodiscard]] std::string summary_text(const log::RunSummary& summary, simulation::Fall fall);

}  // namespace stilt::cli
