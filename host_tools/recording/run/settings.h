#pragma once

#include <array>
#include <vector>

#include "firmware/configuration/parameters.h"
#include "host_tools/recording/run_record.h"
#include "mpc_core/model/robot.h"

namespace stilt::record {

/// Every key of a configuration and its value as TOML, in the order of the file.
[[nodiscard]] std::vector<log::Setting> settings_of(const configuration::Configuration& configuration);

/// Torque limits of a robot that a configuration allows: that of all, and that of plans and torque law where
/// it is less.
[[nodiscard]] std::vector<std::array<double, model::kJoints>> allowed_torque_Nm(
    const configuration::Configuration& configuration, const model::RobotConstants& robot);

}  // namespace stilt::record
