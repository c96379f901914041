#pragma once

#include "codegen/urdf/planar_tree.h"
#include "host_tools/simulation/plant/plant.h"
#include "host_tools/simulation/plant/plant_options.h"

namespace stilt::simulation {

/// The plant of a robot with joints hip_L, knee_L, hip_R, knee_R in the world of the options. Throws
/// std::invalid_argument, one sentence, when the robot has other joints, or when the contact is too stiff for
/// the time step.
[[nodiscard]] PlantModel make_plant_model(codegen::PlanarTree tree, const PlantOptions& options,
                                          double nominal_hip_height_m);

}  // namespace stilt::simulation
