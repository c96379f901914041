#pragma once

#include <array>

#include "firmware/commissioning/identify.h"
#include "firmware/commissioning/jog.h"
#include "firmware/program/options.h"
#include "hal/bring_up/bring_up.h"

namespace stilt::program {

/// Temperatures and supplies that drivers may have, and how long the loop may stand still: the supervisor's.
[[nodiscard]] commissioning::DriverLimits driver_limits(const Options& options);
/// What jog and identify may do by the command line and the configuration. Torque is bounded by the command's
/// own share and by supervisor.torque_limit_share, whichever is smaller. `robot` outlives the requests.
[[nodiscard]] commissioning::JogRequest jog_request(const Options& options, const model::RobotModel& robot);
/// Travel and speed of the joints at the drivers' shafts, for what a scan reads back.
[[nodiscard]] std::array<hal::bring_up::Options, hal::kJoints> wanted_of_drivers(
    const Options& options, const model::RobotModel& robot);
[[nodiscard]] commissioning::IdentificationRequest identification_request(const Options& options,
                                                                          const model::RobotModel& robot);

}  // namespace stilt::program
