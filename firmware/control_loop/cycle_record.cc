#include "firmware/control_loop/cycle_record.h"

#include <algorithm>

namespace stilt::control_loop {

void preview_plan(const control::Plan& plan, double spacing_s, PlanPreview& preview) noexcept {
  preview.sequence = plan.sequence;
  preview.start_time_s = plan.start_time_s;
  preview.count = 0;
  if (plan.nodes < 1) return;
  const int last = plan.nodes - 1;
  const double length_s = plan.node[last].time_s - plan.node[0].time_s;
  const double apart_s = std::max(spacing_s, length_s / (PlanPreview::kMaxNodes - 2));
  constexpr double kRounding_s = 1e-9;
  double next_s = plan.node[0].time_s;
  for (int k = 0; k <= last; ++k) {
    const control::PlanNode& from = plan.node[k];
    if ((from.time_s < next_s - kRounding_s && k != last) || preview.count == PlanPreview::kMaxNodes)
      continue;
    preview.node[static_cast<std::size_t>(preview.count++)] = {from.time_s, from.state, from.input,
                                                               from.mode};
    next_s = from.time_s + apart_s;
  }
}

}  // namespace stilt::control_loop
