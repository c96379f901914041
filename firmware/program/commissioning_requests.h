#pragma once

#include "firmware/commissioning/identify.h"
#include "firmware/commissioning/jog.h"
#include "firmware/program/options.h"

namespace stilt::program {

/// What jog and identify may do by the command line and the configuration. Torque is bounded by the command's
/// own share and by supervisor.torque_limit_share, whichever is smaller. `robot` outlives the requests.
[[nodiscard]] commissioning::JogRequest jog_request(const Options& options, const model::RobotModel& robot);
[[nodiscard]] commissioning::IdentificationRequest identification_request(const Options& options,
                                                                          const model::RobotModel& robot);

}  // namespace stilt::program
