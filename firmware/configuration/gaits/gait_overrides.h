#pragma once

#include <string>
#include <vector>

#include "firmware/configuration/configuration.h"
#include "mpc_core/gait/gait_library.h"

namespace stilt::gait_files {

/// What plans around the gaits of a library need of the configuration, put before what the user sets so
/// that it can be changed. Times of support are as in the gaits. The terminal weight is 10, and its LQR
/// leaves the weights of the feet out (both compared in docs/tuning.md). The weights of the feet's
/// positions and velocities are 15 and 6: all of 24 cases survive 150 N at a horizon of 0.5 s. With 70 or
/// with 12 two or three fall at 140 N.
/// @param where  what asked for these gaits, named in diagnostics
[[nodiscard]] std::vector<configuration::Override> gait_overrides(const gait::GaitLibrary& library,
                                                                  const std::string& where);

}  // namespace stilt::gait_files
