#include "mpc_core/model/robot.h"

// Compiled without contraction, so that a robot's coefficients are the same on every machine.
namespace stilt::model {

RobotModel make_robot(RobotConstants constants) noexcept {
  using enum Number;
  const double* numbers = constants.numbers;
  constants.total_mass_kg = numbers[torso_mass_kg];
  for (int leg = 0; leg < kFeet; ++leg) {
    constants.total_mass_kg += numbers[thigh_mass_kg];
    constants.total_mass_kg += numbers[shin_mass_kg];
  }
  constants.thigh_length_m = numbers[thigh_length_m];
  constants.shin_length_m = numbers[shin_length_m];
  constants.torso_com_height_m = numbers[torso_com_m];
  RobotModel robot{.constants = constants, .coefficients = {}};
  generated::five_link::prepare(numbers, robot.coefficients);
  return robot;
}

}  // namespace stilt::model
