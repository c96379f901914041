#include "firmware/configuration/robot_bring_up.h"

#include <limits>

#include "firmware/configuration/reach.h"

namespace stilt::configuration {

std::array<hal::bring_up::Options, hal::kJoints> bring_up_options(const HardwareParameters& hardware,
                                                                  const model::RobotConstants& robot,
                                                                  bool angles_known) {
  constexpr double kAnywhere_rad = std::numeric_limits<double>::infinity();
  const double margin_rad = angles_known ? kTravelMargin_rad : kAnywhere_rad;
  std::array<hal::bring_up::Options, hal::kJoints> options;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    options[joint] =
        bring_up_options(hardware, joint, robot.position_min_rad[joint] - margin_rad,
                         robot.position_max_rad[joint] + margin_rad, robot.velocity_limit_rad_s[joint]);
  }
  return options;
}

}  // namespace stilt::configuration
