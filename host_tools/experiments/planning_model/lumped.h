#pragma once

#include "mpc_core/model/robot.h"

namespace stilt::planning_model {

/// What a planner neglects that takes the legs for weightless.
enum class Lump {
  legs,    ///< mass and inertia of thighs and shins are part of the torso
  drives,  ///< and the joints' reflected drive inertia is left out
};

/// The robot as a planner sees it that neglects its legs' motion. Mass and inertia of thighs and shins are
/// moved into the torso, as one rigid body with the legs hanging straight: total mass, centre of mass and
/// moment of inertia of that posture stay, as do kinematics and limits. A thousandth of each link stays in
/// the legs: with none the impact map would divide by zero where the drives' inertia is left out. `robot`
/// must outlive the program's use of it; the result lives as long as the program. Thread-safe.
[[nodiscard]] const model::RobotModel& lumped(const model::RobotModel& robot, Lump lump);

}  // namespace stilt::planning_model
