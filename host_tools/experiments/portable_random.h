#pragma once

#include <random>

namespace stilt::experiments {

/// A number uniform in [low, high). Not a distribution of the standard library: those differ between
/// libraries.
[[nodiscard]] inline double between(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
}

}  // namespace stilt::experiments
