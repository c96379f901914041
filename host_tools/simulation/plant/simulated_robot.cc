#include "host_tools/simulation/plant/simulated_robot.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

#include "host_tools/simulation/plant/mjcf.h"
#include "host_tools/simulation/plant/number.h"

namespace stilt::simulation {
namespace {

/// MuJoCo replaces a shorter time constant by twice the time step without a message.
void check_contact(const PlantOptions& options) {
  const double shortest_s = 2.0 * options.time_step_s;
  if (options.contact_time_constant_s >= shortest_s) return;
  throw std::invalid_argument(
      "--plant contact_time_constant_s=" + number_text(options.contact_time_constant_s) +
      ": must be at least " + number_text(shortest_s) + " s, twice the time step of the physics");
}

void change_links(const PlantOptions& options, codegen::PlanarTree& tree) {
  if (options.torso_com_m) tree.links[0].com_m.z = *options.torso_com_m;
  for (std::size_t i = 0; i < std::min(tree.links.size(), options.links.size()); ++i) {
    const LinkChange& change = options.links[i];
    codegen::PlanarLink& link = tree.links[i];
    link.mass_kg *= change.mass_scale;
    link.inertia_kg_m2 *= change.inertia_scale;
    link.com_m.x += change.com_x_m;
    link.com_m.z += change.com_z_m;
  }
}

}  // namespace

PlantModel make_plant_model(codegen::PlanarTree tree, const PlantOptions& options,
                            double nominal_hip_height_m) {
  check_contact(options);
  change_links(options, tree);
  MjcfOptions world;
  world.time_step_s = options.time_step_s;
  world.foot_radius_m = options.foot_radius_m;
  world.friction = options.friction;
  world.contact_time_constant_s = options.contact_time_constant_s;
  world.contact_damping_ratio = options.contact_damping_ratio;
  world.joint_limits = options.joint_stops;
  world.ground_slope_rad = options.ground_slope_rad;
  if (options.step_height_m != 0.0) world.steps = {{options.step_position_m, options.step_height_m}};
  PlantModel model;
  model.mjcf = to_mjcf(tree, world);
  model.nominal_hip_height_m = nominal_hip_height_m;
  if (tree.joint_count() != model::kJoints) {
    throw std::invalid_argument("robot " + tree.name + " has " + std::to_string(tree.joint_count()) +
                                " joints; the plant needs hip and knee of two legs");
  }
  for (int joint = 0; joint < model::kJoints; ++joint) {
    model.torque_limit_Nm[joint] = tree.links[static_cast<std::size_t>(joint) + 1].joint.torque_max_Nm;
  }
  return model;
}

}  // namespace stilt::simulation
