#pragma once

#include <cstdint>

#include "mpc_core/control/plan.h"

namespace stilt::control_loop {

/// 64 bits that differ when any bit of the plan differs. Included are times, states, inputs, gains and modes
/// of plan.nodes nodes, start, sequence, gait and end of the phase. Two plans with the same number are the
/// same but for one chance in 10^19. Never 0. About 20 us for the longest plan; real-time.
[[nodiscard]] std::uint64_t plan_checksum(const control::Plan& plan) noexcept;

}  // namespace stilt::control_loop
