#pragma once

#include "host_tools/recording/run_record.h"
#include "host_tools/simulation/plant/plant.h"
#include "host_tools/simulation/plant/stance.h"
#include "mpc_core/control/parameters.h"
#include "mpc_core/model/robot.h"

namespace stilt::cli {

/// Standing on the plant's ground at x 0, feet apart as the gait wants.
[[nodiscard]] model::StateVector standing_on_ground(const simulation::PlantOptions& world,
                                                    const simulation::LegLengths& leg,
                                                    const control::ControllerParameters& parameters);

/// Adds to a record what the report needs to draw the run: robot, limits, friction and the ground it walked
/// on.
void describe_run(const model::RobotConstants& robot, const simulation::Plant& plant,
                  const simulation::PlantOptions& world, log::RunRecord& record);

}  // namespace stilt::cli
