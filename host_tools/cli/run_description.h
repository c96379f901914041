#pragma once

#include "host_tools/log/run_record.h"
#include "host_tools/simulator/plant.h"
#include "host_tools/simulator/stance.h"
#include "mpc_core/control/parameters.h"
#include "mpc_core/model/robot.h"

namespace stilt::cli {

/// Standing on the plant's ground at x 0, feet apart as the gait wants.
[[nodiscard]] model::StateVector standing_on_ground(const simulator::PlantOptions& world,
                                                    const simulator::LegLengths& leg,
                                                    const control::ControllerParameters& parameters);

/// Adds to a record what the report needs to draw the run: robot, limits, friction and the ground it walked
/// on.
void describe_run(const model::RobotConstants& robot, const simulator::Plant& plant,
                  const simulator::PlantOptions& world, log::RunRecord& record);

}  // namespace stilt::cli
