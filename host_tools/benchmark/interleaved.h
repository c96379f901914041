#pragma once

#include <functional>
#include <vector>

namespace stilt::benchmark {

/// Medians of the times of several kernels, s, in their order. They take turns, so that whatever slows the
/// machine down for a while meets them all; each turn runs a kernel twice and times the second run, when its
/// data are in the cache.
[[nodiscard]] std::vector<double> interleaved_medians_s(const std::vector<std::function<void()>>& kernels,
                                                        int rounds);

/// The middle value (the upper one of two).
[[nodiscard]] double median(std::vector<double> values);

}  // namespace stilt::benchmark
