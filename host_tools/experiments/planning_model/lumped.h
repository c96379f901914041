#pragma once

#include "mpc_core/model/robot.h"

namespace stilt::planning_model {

/// Properties that a planner with weightless legs neglects.
enum class Lump {
  legs,    ///< mass and inertia of thighs and shins are part of the torso
  drives,  ///< additionally the joints' armature is left out
};

/// The model of a planner that neglects the motion of the legs. Mass and inertia of thighs and shins move
/// into the torso, as one rigid body with the legs straight down. Total mass, centre of mass and moment of
/// inertia of that posture are kept, and so are kinematics and limits. A thousandth of each link remains in
/// the legs: otherwise the impact map would divide by zero without the drives' inertia. `robot` must live as
/// long as the result is used; the result lives as long as the program. Thread-safe.
[[nodiscard]] const model::RobotModel& lumped(const model::RobotModel& robot, Lump lump);

}  // namespace stilt::planning_model
