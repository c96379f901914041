#pragma once

#include <optional>
#include <string>

#include "mpc_core/gait/hzd_gait.h"
#include "mpc_core/model/robot.h"

namespace stilt::gait_synthesis {

/// Why the outputs of a gait from elsewhere have no periodic motion: tries the usual mistakes of units, signs
/// and order, and names the first one whose correction gives a step with bent knees and the swing foot above
/// the ground, as in "the angles are taken as degrees". Nothing when none does. Takes about a second.
[[nodiscard]] std::optional<std::string> likely_mistake(const model::RobotModel& robot,
                                                        const gait::HzdGait& gait);

}  // namespace stilt::gait_synthesis
