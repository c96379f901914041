#pragma once

#include <string>

#include "firmware/control_loop/planner_schedule.h"
#include "host_tools/recording/run_record.h"
#include "host_tools/simulation/plant/plant.h"

namespace stilt::cli {

/// The plant's part of a run's summary as text.
[[nodiscard]] std::string plant_text(const log::RunSummary& summary, simulation::Fall fall);

/// The summary of a run as a few lines of text, with the timing that its plans had.
[[nodiscard]] std::string summary_text(const log::RunSummary& summary, simulation::Fall fall,
                                       const control_loop::PlanTiming& timing);

}  // namespace stilt::cli
