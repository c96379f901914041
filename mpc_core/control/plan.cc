#include "mpc_core/control/plan.h"

#include <algorithm>

#include "mpc_core/model/debug_assert.h"

namespace stilt::control {

using model::kPositions;

PlanPoint interpolate(const Plan& plan, double time_s) noexcept {
  STILT_ASSERT(plan.nodes >= 2 && plan.nodes <= kMaxNodes);
  const int last = plan.nodes - 1;
  int k = 0;
  while (k + 1 < last && plan.node[k + 1].time_s <= time_s) ++k;
  const PlanNode& from = plan.node[k];
  const PlanNode& to = plan.node[k + 1];
  const double duration_s = to.time_s - from.time_s;
  STILT_ASSERT(!(duration_s < 0.0));
  const double s = duration_s > 0.0 ? std::clamp((time_s - from.time_s) / duration_s, 0.0, 1.0) : 1.0;
  PlanPoint point;
  point.state = (1.0 - s) * from.state + s * to.state;
  // Positions follow the cubic through the nodes' positions and velocities. A straight line misses it by a
  // h^2 / 8, 3 mrad at a knee.
  const auto rise_from = from.state.tail<kPositions>() * duration_s;
  const auto rise_to = to.state.tail<kPositions>() * duration_s;
  const auto chord = to.state.head<kPositions>() - from.state.head<kPositions>();
  point.state.head<kPositions>() += s * (1.0 - s) * ((1.0 - s) * (rise_from - chord) - s * (rise_to - chord));
  const bool same_phase = from.mode == to.mode && k + 1 < last;
  point.input = from.input;
  if (same_phase) point.input += s * (to.input - from.input);
  point.gain = &from.gain;
  point.mode = from.mode;
  point.age_s = time_s - plan.start_time_s;
  return point;
}

}  // namespace stilt::control
