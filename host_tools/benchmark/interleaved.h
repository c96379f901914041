#pragma once

#include <functional>
#include <vector>

namespace stilt::benchmark {

/// Medians of the times of several kernels, s, in their order. The kernels take turns, so that a slow phase
/// of the machine affects all of them. Each turn runs a kernel twice and times the second run, when its data
/// are in the cache.
[[nodiscard]] std::vector<double> interleaved_medians_s(const std::vector<std::function<void()>>& kernels,
                                                        int rounds);

/// The median; of an even number of values the upper middle one.
[[nodiscard]] double median(std::vector<double> values);

}  // namespace stilt::benchmark
