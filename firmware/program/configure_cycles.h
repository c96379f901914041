#pragma once

#include <expected>
#include <string>

#include "firmware/configuration/configuration.h"
#include "firmware/controller/planner_cycle.h"
#include "firmware/controller/torque_cycle.h"

namespace stilt::program {

/// Planner and torque loop as a configuration wants them: in stiltd, and when a record is replayed. `source`
/// names the configuration in the error, one sentence for the user. Start-up only.
/// @param gaits  filled with the gaits shipped for the robot, where the configuration wants them; outlives
/// both
///               cycles. nullptr: do without
[[nodiscard]] std::expected<void, std::string> configure_cycles(
    const configuration::Configuration& configuration, const std::string& source,
    controller::PlannerCycle& planner, controller::TorqueCycle& torque, gait::GaitLibrary* gaits = nullptr);

}  // namespace stilt::program
