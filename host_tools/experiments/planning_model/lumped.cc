#include "host_tools/experiments/planning_model/lumped.h"

#include <map>
#include <mutex>
#include <utility>

namespace stilt::planning_model {
namespace {

using enum model::Number;

constexpr double kLeft = 0.001;  ///< share of the legs' mass and inertia that remains in them

/// A rigid body to which others are added, along the line of the straight robot.
struct Body {
  double mass_kg;
  double com_m;          ///< above the hip
  double inertia_kg_m2;  ///< about the centre of mass

  void add(const Body& other) noexcept {
    const double sum_kg = mass_kg + other.mass_kg;
    const double apart_m = com_m - other.com_m;
    inertia_kg_m2 += other.inertia_kg_m2 + mass_kg * other.mass_kg / sum_kg * apart_m * apart_m;
    com_m = (mass_kg * com_m + other.mass_kg * other.com_m) / sum_kg;
    mass_kg = sum_kg;
  }
};

model::RobotModel lump_legs(const model::RobotModel& robot, Lump lump) noexcept {
  model::RobotConstants constants = robot.constants;
  double* numbers = constants.numbers;
  constexpr double kMoved = 1.0 - kLeft;
  Body torso{numbers[torso_mass_kg], numbers[torso_com_m], numbers[torso_inertia_kg_m2]};
  for (int leg = 0; leg < model::kFeet; ++leg) {
    torso.add(
        {kMoved * numbers[thigh_mass_kg], -numbers[thigh_com_m], kMoved * numbers[thigh_inertia_kg_m2]});
    torso.add({kMoved * numbers[shin_mass_kg], -numbers[thigh_length_m] - numbers[shin_com_m],
               kMoved * numbers[shin_inertia_kg_m2]});
  }
  numbers[torso_mass_kg] = torso.mass_kg;
  numbers[torso_com_m] = torso.com_m;
  numbers[torso_inertia_kg_m2] = torso.inertia_kg_m2;
  for (const model::Number moved : {thigh_mass_kg, thigh_inertia_kg_m2, shin_mass_kg, shin_inertia_kg_m2}) {
    numbers[moved] *= kLeft;
  }
  if (lump == Lump::drives) {
    for (int j = 0; j < model::kJoints; ++j) constants.joint_parameters[j] = 0.0;
  }
  return model::make_robot(constants);
}

}  // namespace

const model::RobotModel& lumped(const model::RobotModel& robot, Lump lump) {
  static std::mutex mutex;
  static std::map<std::pair<const model::RobotModel*, Lump>, model::RobotModel> models;
  const std::lock_guard lock(mutex);
  const std::pair key{&robot, lump};
  const auto known = models.find(key);
  return known != models.end() ? known->second : models.emplace(key, lump_legs(robot, lump)).first->second;
}

}  // namespace stilt::planning_model
