#pragma once

#include "host_tools/recording/run_record.h"
#include "mpc_core/gait/command.h"

namespace stilt::experiments {

/// The mean speed that a command requires: zero for standing and for stepping in place.
[[nodiscard]] double commanded_speed_m_s(const gait::GaitCommand& command);

/// Whether a run followed its command. The robot stays on its feet to the end, and its mean speed is within
/// 10 % of the command, within 0.03 m/s at zero. A robot commanded to stand must take no step.
[[nodiscard]] bool walks(const gait::GaitCommand& command, const log::RunSummary& summary);

}  // namespace stilt::experiments
