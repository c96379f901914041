#include "mpc_core/ocp/horizon.h"

#include <algorithm>
#include <cmath>

#include "mpc_core/model/debug_assert.h"

namespace stilt::ocp {
namespace {

/// Nodes are in order; only a transition takes no time.
[[maybe_unused]] bool times_ascend(const Horizon& horizon) noexcept {
  for (int k = 0; k < horizon.stages; ++k) {
    const bool flows = horizon.stage[k].kind == StageKind::flow;
    const double duration_s = horizon.node_time_s(k + 1) - horizon.stage[k].time_s;
    if (flows ? !(duration_s > 0.0) : duration_s != 0.0) return false;
  }
  return horizon.stages > 0;
}

/// Times that are equal but for rounding count as equal.
constexpr double kRounding = 1e-9;

}  // namespace

double most_intervals(const DiscretisationParameters& p) noexcept {
  return std::ceil(p.horizon_s / p.time_step_s - kRounding);
}

double most_switches(const DiscretisationParameters& p, const gait::GaitParameters& gait) noexcept {
  const double horizon_s = p.horizon_s + kRounding;
  const double single_s = gait.single_support_s;
  const double double_s = gait.double_support_s;
  if (double_s <= 0.0) return 1.0 + std::floor(horizon_s / single_s);
  // Gaps between switches alternate; the window that holds most starts at a switch, before the shorter gap.
  const double period_s = single_s + double_s;
  const double periods = std::floor(horizon_s / period_s);
  const double rest_s = horizon_s - periods * period_s;
  return 1.0 + 2.0 * periods + (rest_s >= std::min(single_s, double_s) ? 1.0 : 0.0);
}

bool build_horizon(const gait::ContactSchedule& schedule, double start_s, const DiscretisationParameters& p,
                   Horizon& horizon) noexcept {
  STILT_ASSERT(std::isfinite(start_s) && p.time_step_s > 0.0 && p.horizon_s > 0.0 && p.merge_below_s >= 0.0);
  const double end_s = start_s + p.horizon_s;
  double time_s = start_s;
  int phase = schedule.index_at(start_s - p.switch_tolerance_s);
  int grid = 1;
  horizon.stages = 0;
  horizon.end_s = end_s;
  while (time_s < end_s) {
    if (horizon.stages >= kMaxStages) return false;
    Stage& stage = horizon.stage[horizon.stages];
    stage.time_s = time_s;

    const double switch_s = schedule.end_s(phase);
    if (switch_s <= time_s + p.merge_below_s) {
      const model::ContactMode before = schedule.phase(phase).mode;
      stage.phase = ++phase;
      stage.mode = schedule.phase(phase).mode;
      stage.touchdown = {stage.mode.left && !before.left, stage.mode.right && !before.right};
      if (!stage.touchdown[0] && !stage.touchdown[1]) continue;  // lift-off changes nothing
      stage.kind = StageKind::transition;
      stage.duration_s = 0.0;
      ++horizon.stages;
      continue;
    }

    while (start_s + grid * p.time_step_s <= time_s + p.merge_below_s) ++grid;
    double next_s = start_s + grid * p.time_step_s;
    if (next_s > end_s - p.merge_below_s) next_s = end_s;
    // A switch just behind the node takes its place, by the comparison above: otherwise the node would take
    // the switch. A switch just before the end would leave a sliver behind it: it is left beyond the horizon.
    if (switch_s <= next_s + p.merge_below_s) next_s = switch_s < end_s - p.merge_below_s ? switch_s : end_s;
    stage.kind = StageKind::flow;
    stage.phase = phase;
    stage.mode = schedule.phase(phase).mode;
    stage.touchdown = {};
    stage.duration_s = next_s - time_s;
    time_s = next_s;
    ++horizon.stages;
  }
  horizon.end_phase = phase;
  STILT_ASSERT(times_ascend(horizon));
  return true;
}

}  // namespace stilt::ocp
