#pragma once

#include <expected>
#include <string>

#include "firmware/configuration/configuration.h"
#include "firmware/control_loop/control_loop.h"
#include "firmware/control_loop/planner_task.h"

namespace stilt::program {

/// Planner and control loop as a configuration sets them: in stiltd, and when a record is replayed. `source`
/// names the configuration in the error, one sentence for the user. Start-up only.
/// @param gaits  filled with the robot's shipped gaits where the configuration uses them, nullptr: none;
///               outlives both cycles
[[nodiscard]] std::expected<void, std::string> configure_controller(
    const configuration::Configuration& configuration, const std::string& source,
    control_loop::PlannerTask& planner, control_loop::ControlLoop& loop, gait::GaitLibrary* gaits = nullptr);

}  // namespace stilt::program
