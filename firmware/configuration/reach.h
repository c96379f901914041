#pragma once

#include <span>
#include <string>
#include <vector>

#include "firmware/configuration/configuration.h"
#include "mpc_core/model/robot.h"

namespace stilt::configuration {

/// Joints may be found a little beyond their travel.
inline constexpr double kTravelMargin_rad = 0.1;

/// A sentence for each pose that the robot cannot take. Feet of the standing pose may be beyond the reach of
/// the legs, and joints of both poses beyond their travel. The feet of the sitting pose may not carry the
/// robot, and a joint may be too fast on the way there. Allocates; not for real time.
[[nodiscard]] std::vector<std::string> unreachable_poses(const Configuration& configuration,
                                                         const model::RobotConstants& robot);

/// Those, and a sentence for each angle, velocity and torque of the robot that the frames of its drivers
/// cannot carry. A command beyond the end of its field saturates, and so does a reading. The driver would
/// pull towards that end, or give less than is planned. A joint beyond it would look at rest there. Start-up
/// and host programs only.
[[nodiscard]] std::vector<std::string> unreachable(const Configuration& configuration,
                                                   const model::RobotConstants& robot);

}  // namespace stilt::configuration
