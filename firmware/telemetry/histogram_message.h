#pragma once

#include <string>
#include <vector>

#include "firmware/diagnostics/histogram.h"
#include "firmware/telemetry/sequence.h"

namespace stilt::telemetry {

/// A histogram as Timing_ carries it: the bins from the first to the last that holds something.
class HistogramMessage {
 public:
  HistogramMessage(std::string name, const diagnostics::Histogram& histogram, double deadline_us)
      : name_(std::move(name)) {
    const diagnostics::Percentiles percentiles = histogram.percentiles();
    message_.deadline_us = deadline_us;
    message_.count = histogram.count();
    message_.p50_us = percentiles.p50_us;
    message_.p99_us = percentiles.p99_us;
    message_.p999_us = percentiles.p999_us;
    message_.max_us = percentiles.max_us;
    std::size_t used = 0;
    for (std::size_t bin = 0; bin < diagnostics::Histogram::kBins; ++bin) {
      if (used == 0 && histogram.in_bin(bin) == 0) continue;
      edges_.push_back(bin == 0 ? 0.0f : static_cast<float>(diagnostics::Histogram::upper_edge_us(bin - 1)));
      bins_.push_back(histogram.in_bin(bin));
      if (histogram.in_bin(bin) != 0) used = bins_.size();
    }
    edges_.resize(used);
    bins_.resize(used);
  }

  /// Valid as long as this object.
  [[nodiscard]] const stilt_msgs_msg_dds__Histogram_& message() {
    set_view(message_.name, name_);
    set_view(message_.lower_edge_us, edges_);
    set_view(message_.bin, bins_);
    return message_;
  }

 private:
  std::string name_;
  std::vector<float> edges_;
  std::vector<std::uint64_t> bins_;
  stilt_msgs_msg_dds__Histogram_ message_{};
};

}  // namespace stilt::telemetry
