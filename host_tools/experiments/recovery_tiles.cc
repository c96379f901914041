#include "host_tools/experiments/recovery_tiles.h"

#include <algorithm>
#include <span>

#include "host_tools/experiments/postures.h"
#include "host_tools/experiments/table_text.h"

namespace stilt::experiments {
namespace {

constexpr std::size_t kMostTiles = 16;

/// Number of touch-downs at or before a time.
std::size_t landed_by(std::span<const log::Step> steps, double time_s) {
  return static_cast<std::size_t>(std::ranges::upper_bound(steps, time_s, {}, &log::Step::time_s) -
                                  steps.begin());
}

/// The touch-downs to draw.
std::span<const log::Step> shown(const log::RunRecord& record, const PushedWalk& push) {
  const std::span<const log::Step> steps = record.summary.steps;
  const std::size_t before = landed_by(steps, push.start_s);
  const std::size_t first = before > 0 ? before - 1 : 0;
  std::size_t end = steps.size();
  if (push.recovery_steps) {
    end = std::min(end, landed_by(steps, push.end_s) + static_cast<std::size_t>(*push.recovery_steps));
  }
  return steps.subspan(first, std::min(end - first, kMostTiles));
}

bool acts(const PushedWalk& push, double time_s) { return time_s > push.start_s && time_s <= push.end_s; }

}  // namespace

plot::Plot recovery_tiles(const log::RunRecord& record, const PushedWalk& push, const std::string& title) {
  constexpr double kApart_m = 1.05;
  constexpr double kTimes_m = 1.45;  // heights of the texts
  constexpr double kLengths_m = -0.13;
  plot::Plot figure{title, "x, tiles set apart (m)", "z (m)", {}, true, 1380.0, 290.0};
  double x_m = 0.0;
  for (const log::Step& step : shown(record, push)) {
    const auto sample = std::ranges::lower_bound(record.samples, step.time_s, {}, &log::RunSample::time_s);
    if (sample == record.samples.end()) break;
    const Posture posture = posture_of(record.robot, sample->true_state);
    draw(record.robot, posture, x_m - posture.hip_x_m, figure);
    const char* colour = acts(push, step.time_s) ? "var(--bad)" : "var(--muted)";
    figure.labels.push_back({x_m, kTimes_m, text("%+.2f s", step.time_s - push.start_s), colour});
    figure.labels.push_back({x_m, kLengths_m, text("%.2f m", step.length_m), colour});
    x_m += kApart_m;
  }
  return figure;
}

Json recovery_json(const log::RunRecord& record, const PushedWalk& push) {
  Json steps = Json::array();
  for (const log::Step& step : shown(record, push)) {
    steps.push_back({{"time_s", step.time_s},
                     {"foot", step.foot},
                     {"length_m", step.length_m},
                     {"pushed", acts(push, step.time_s)}});
  }
  return {{"force_N", push.force_N},
          {"survived", record.summary.survived},
          {"recovery_steps", push.recovery_steps ? Json(*push.recovery_steps) : Json(nullptr)},
          {"steps", std::move(steps)}};
}

}  // namespace stilt::experiments
