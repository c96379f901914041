#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "codegen/urdf/planar_tree.h"
#include "host_tools/simulator/plant.h"
#include "host_tools/simulator/plant_options.h"

namespace stilt::simulator {

/// Names of the robots whose URDF is compiled into the program.
[[nodiscard]] std::vector<std::string> simulated_robot_names();

/// The compiled-in URDF of a robot; empty for an unknown name.
[[nodiscard]] std::string_view simulated_robot_urdf(std::string_view name);

/// The planar tree of a compiled-in URDF. Throws std::invalid_argument, one sentence, for an unknown name.
[[nodiscard]] codegen::PlanarTree simulated_robot(std::string_view name);

/// The plant of a robot with joints hip_L, knee_L, hip_R, knee_R in the world that the options describe.
/// Throws std::invalid_argument, one sentence, when the robot has other joints or the contact is too stiff
/// for the time step.
[[nodiscard]] PlantModel make_plant_model(codegen::PlanarTree tree, const PlantOptions& options,
                                          double nominal_hip_height_m);

}  // namespace stilt::simulator
