#pragma once

#include "host_tools/recording/run_record.h"
#include "host_tools/simulation/plant/plant.h"
#include "host_tools/simulation/plant/stance.h"
#include "mpc_core/control/parameters.h"
#include "mpc_core/model/robot.h"

namespace stilt::cli {

/// State that stands on the plant's ground at x = 0, with the feet apart as the gait parameters require.
/// Throws std::invalid_argument, one sentence with the options of the ground, where a foot does not reach it.
[[nodiscard]] model::StateVector standing_on_ground(const simulation::PlantOptions& world,
                                                    const simulation::LegLengths& leg,
                                                    const control::ControllerParameters& parameters);

/// Adds the data that the report needs for drawing the run: robot, limits, friction and ground.
void describe_run(const model::RobotConstants& robot, const simulation::Plant& plant,
                  const simulation::PlantOptions& world, log::RunRecord& record);

}  // namespace stilt::cli
