#pragma once

#include <optional>
#include <string>

#include "mpc_core/gait/hzd_gait.h"
#include "mpc_core/model/robot.h"

namespace stilt::gait_synthesis {

/// Finds why the outputs of an imported gait have no periodic motion, by trying the usual mistakes of units,
/// signs and order. Returns the first one whose correction gives a step with bent knees and the swing foot
/// above the ground. An example is "the angles are taken as degrees". Nothing when there is none. Takes about
/// a second.
[[nodiscard]] std::optional<std::string> likely_mistake(const model::RobotModel& robot,
                                                        const gait::HzdGait& gait);

}  // namespace stilt::gait_synthesis
