#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "firmware/configuration/parameters.h"

namespace stilt::configuration {

/// Two or more values that are valid by themselves and contradict each other.
struct Contradiction {
  std::vector<std::string_view> keys;  ///< "section.key" of the values involved, the likeliest culprit first
  std::string message;                 ///< what is wrong, and what would be right
};

/// All contradictions: horizon and switches against the capacity of the planner, rates, durations, swing,
/// wiring.
/// Supposes that every value is within its range. May allocate; not for real time.
[[nodiscard]] std::vector<Contradiction> contradictions(const Configuration& parameters);

}  // namespace stilt::configuration
