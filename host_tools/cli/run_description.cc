#include "host_tools/cli/run_description.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include "host_tools/cli/robot_drawing.h"
#include "host_tools/simulation/plant/number.h"

namespace stilt::cli {
namespace {

/// Adds corners of the ground's profile, from slightly behind to slightly beyond the places of the robot.
void add_ground(const simulation::Plant& plant, const simulation::PlantOptions& world,
                log::RunRecord& record) {
  constexpr double kMargin_m = 5.0;
  constexpr double kEdge_m = 1e-6;
  double least_x_m = std::min(0.0, record.summary.distance_m);
  double largest_x_m = std::max(0.0, record.summary.distance_m);
  for (const log::RunSample& sample : record.samples) {
    least_x_m = std::min(least_x_m, sample.true_state[0]);
    largest_x_m = std::max(largest_x_m, sample.true_state[0]);
  }
  std::vector<double> corners = {least_x_m - kMargin_m, largest_x_m + kMargin_m};
  const double step_m = world.step_position_m;
  if (world.step_height_m != 0.0 && step_m > corners.front() && step_m < corners.back()) {
    corners.insert(corners.begin() + 1, {step_m - kEdge_m, step_m});
  }
  for (const double x_m : corners) {
    record.ground_x_m.push_back(x_m);
    record.ground_z_m.push_back(plant.ground_height_m(x_m));
  }
}

/// The options that make the ground uneven; empty: none.
std::string ground_options(const simulation::PlantOptions& world) {
  std::string options;
  if (world.ground_slope_rad != 0.0)
    options = "--plant ground_slope_rad=" + simulation::number_text(world.ground_slope_rad);
  if (world.step_height_m != 0.0) {
    options += (options.empty() ? "" : ", ") +
               ("--plant step_height_m=" + simulation::number_text(world.step_height_m));
  }
  return options;
}

}  // namespace

model::StateVector standing_on_ground(const simulation::PlantOptions& world,
                                      const simulation::LegLengths& leg,
                                      const control::ControllerParameters& parameters) {
  const double half_width_m = parameters.gait.stand_half_width_m;
  try {
    return simulation::standing_state(leg, parameters.reference.base_height_m, half_width_m,
                                      {simulation::ground_height_m(world, half_width_m),
                                       simulation::ground_height_m(world, -half_width_m)});
  } catch (const std::invalid_argument& mistake) {
    const std::string options = ground_options(world);
    if (options.empty()) throw;
    throw std::invalid_argument(options + ": no place to stand: " + mistake.what());
  }
}

void describe_run(const model::RobotConstants& robot, const simulation::Plant& plant,
                  const simulation::PlantOptions& world, log::RunRecord& record) {
  record.robot = drawing_of(robot);
  for (int joint = 0; joint < model::kJoints; ++joint) {
    record.torque_limit_Nm[joint] = plant.torque_limit_Nm()[joint];
  }
  for (std::array<double, model::kJoints>& allowed_Nm : record.allowed_torque_Nm) {
    std::ranges::transform(allowed_Nm, record.torque_limit_Nm, allowed_Nm.begin(), std::ranges::min);
  }
  record.friction_coefficient = world.friction;
  add_ground(plant, world, record);
}

}  // namespace stilt::cli
