#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "firmware/configuration/schema.h"

/// The tunables that may change while the robot runs: weights of the cost, gains of the torque law, the
/// height of hip and swing. The list is the same in every build of one version; its order is that of the
/// schema.
namespace stilt::configuration {

/// One of them and what it may be set to.
struct LiveTunable {
  const Entry* entry;
  double start_value;  ///< as configured
  double minimum;
  double maximum;
};

/// All of them for a configuration. A live value stays near the configured one, and within the schema's
/// range. Weights, gains and swing height stay within a factor of four, the hip's height from 8 cm below to 2
/// cm above.
[[nodiscard]] std::vector<LiveTunable> live_tunables(const Configuration& configuration);

/// The configuration with other values of its live tunables.
/// @param values  in the order of live_tunables(); as many as it has, or fewer
[[nodiscard]] Configuration with_live_values(const Configuration& configuration,
                                             std::span<const double> values);

}  // namespace stilt::configuration
