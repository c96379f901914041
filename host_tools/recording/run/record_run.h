#pragma once

#include <string>
#include <vector>

#include "host_tools/recording/run_record.h"
#include "mpc_core/model/robot.h"

namespace stilt::record {

/// A file of a run as the report shows it.
struct RecordRun {
  log::RunRecord run;
  model::RobotConstants robot{};      ///< its name is that of the run's drawing
  std::size_t runs = 1;               ///< of stiltd in the file; the one with most ticks is taken
  std::vector<std::string> problems;  ///< of the file, one sentence each: the readable part is there
};

/// Reads the run with most ticks of a record of stilt record: estimate, torques that the drivers report,
/// plans for drawing, solves, events, settings. Times are those of the controller, s since tick 0. What only
/// a simulation has is NaN, and so is the place of the hip while the robot is off its feet. Steps are
/// touch-downs of measured foot forces where the robot has such sensors, otherwise those of the plans. Throws
/// std::runtime_error, one sentence, when the file is no record, has another wire version, or lacks
/// configuration or ticks.
[[nodiscard]] RecordRun run_of_record(const std::string& path);

}  // namespace stilt::record
