#pragma once

#include <span>

#include "host_tools/experiments/disturbance.h"

namespace stilt::experiments {

/// The fields of one row from the results of its cases; merge_disturbance() lists the fields.
[[nodiscard]] Json merged_row(const PushRow& row, std::span<const Json> cases);

}  // namespace stilt::experiments
