#pragma once

#include <string_view>

#include "mpc_core/model/robot.h"

namespace stilt::planning_model {

/// What a planner neglects that takes the legs for weightless.
enum class Lump {
  legs,    ///< mass and inertia of thighs and shins are part of the torso
  drives,  ///< and the joints' reflected drive inertia is left out
};

/// The robot of that name as a planner sees it that neglects its legs' motion
/// (codegen/robots/NAME_lumped.urdf); kinematics and limits are unchanged. Null when there is none for that
/// robot.
[[nodiscard]] const model::RobotModel* lumped(std::string_view robot, Lump lump) noexcept;

}  // namespace stilt::planning_model
