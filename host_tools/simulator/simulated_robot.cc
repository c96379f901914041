#include "host_tools/simulator/simulated_robot.h"

#include <stdexcept>

#include "codegen/model/urdf_reader.h"
#include "host_tools/simulator/embedded_urdf.h"
#include "host_tools/simulator/mjcf.h"

namespace stilt::simulator {

std::vector<std::string> simulated_robot_names() {
  std::vector<std::string> names;
  for (const EmbeddedUrdf& robot : kEmbeddedUrdfs) names.emplace_back(robot.name);
  return names;
}

std::string_view simulated_robot_urdf(std::string_view name) {
  for (const EmbeddedUrdf& robot : kEmbeddedUrdfs) {
    if (robot.name == name) return robot.text;
  }
  return {};
}

codegen::PlanarTree simulated_robot(std::string_view name) {
  std::string known;
  for (const EmbeddedUrdf& robot : kEmbeddedUrdfs) {
    if (robot.name == name) return codegen::parse_urdf(std::string(robot.text), std::string(name) + ".urdf");
    known += (known.empty() ? "" : ", ") + std::string(robot.name);
  }
  throw std::invalid_argument("--robot " + std::string(name) + ": no such robot; known are " + known);
}

PlantModel make_plant_model(const codegen::PlanarTree& tree, const PlantOptions& options,
                            double nominal_hip_height_m) {
  MjcfOptions world;
  world.time_step_s = options.time_step_s;
  world.foot_radius_m = options.foot_radius_m;
  world.friction = options.friction;
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

}  // namespace stilt::simulator
