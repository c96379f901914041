#pragma once

#include "host_tools/cli/json_output.h"
#include "host_tools/cli/robot_command.h"
#include "host_tools/recording/run_record.h"
#include "host_tools/simulation/robot_on_bus/frame_log.h"
#include "host_tools/simulation/robot_on_bus/runner.h"

namespace stilt::cli {

/// The files that `stilt robot` writes.
[[nodiscard]] OutputFiles outputs_of(const RobotOptions& options);

/// Prints the outcome of `stilt robot`, and writes --json, --log, --report and --frames; a file that cannot
/// be written keeps none of the others back. Throws UsageError, one sentence for each of those.
///
/// All times are on one clock, that of the controller that stood it up, so that they compare with the
/// events that stiltd prints. What is on the robot's own clock has robot_time_s in its name, or is
/// controllers_came_s.
/// @param record  on the clock of its recorder, which starts at the release by the gantry
void write_robot_results(const RobotOptions& options, const robot_on_bus::RobotOnBus& robot,
                         log::RunRecord record, const robot_on_bus::RunOutcome& outcome,
                         robot_on_bus::FrameLog& frames);

}  // namespace stilt::cli
