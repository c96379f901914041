#pragma once

#include <span>

#include "host_tools/experiments/disturbance.h"

namespace stilt::experiments {

/// What a row of the results has of its plan: controller, horizon, gait, direction, search and setting.
[[nodiscard]] Json described(const DisturbancePlan& plan, const PushRow& row);

/// The fields of one row from the results of its cases; merge_disturbance() lists the fields.
[[nodiscard]] Json merged_row(const DisturbancePlan& plan, const PushRow& row, std::span<const Json> cases);

}  // namespace stilt::experiments
