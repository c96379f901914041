#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/configuration/configuration.h"
#include "mpc_core/gait/gait_library.h"

namespace stilt::gait_files {

/// What plans around the gaits of a library need of the configuration, put before what the user sets so
/// that it can be changed. The step time cannot. Times of support are as in the gaits. The terminal weight
/// is 10, and its LQR leaves the weights of the feet out (both compared in docs/tuning.md). The weights of
/// the feet's positions and velocities are 15 and 6: all of 24 cases survive 150 N at a horizon of 0.5 s.
/// With 70 or with 12 two or three fall at 140 N.
/// @param where  what asked for these gaits, named in diagnostics
[[nodiscard]] std::vector<configuration::Override> gait_overrides(const gait::GaitLibrary& library,
                                                                  const std::string& where);

/// What is wrong with a configuration whose step time is not that of the gaits that its plans follow. The
/// swing would last as long as the configuration says, and the joints would move as in the gaits: no motion
/// has both.
[[nodiscard]] std::optional<std::string> other_step_time(const gait::GaitLibrary& library,
                                                         const configuration::Configuration& configuration);

}  // namespace stilt::gait_files
