#pragma once

#include "host_tools/recording/run_record.h"
#include "mpc_core/model/robot.h"

namespace stilt::cli {

/// Height of the drawn torso above the hip, in heights of its centre of mass.
inline constexpr double kTorsoToCom = 1.75;

/// Lengths of a robot for drawing it.
[[nodiscard]] inline log::RobotDrawing drawing_of(const model::RobotConstants& robot) {
  return {robot.name, kTorsoToCom * robot.torso_com_height_m, robot.thigh_length_m, robot.shin_length_m};
}

}  // namespace stilt::cli
