#include "host_tools/cli/summary_text.h"

#include <cstdarg>
#include <cstdio>

#include "host_tools/recording/mean_speed.h"

namespace stilt::cli {
namespace {

[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...) {
  char buffer[256];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof buffer, format, arguments);
  va_end(arguments);
  return buffer;
}

std::string steps_line(const log::RunSummary& summary) {
  if (summary.steps.empty()) return "steps          none\n";
  return formatted("steps          %zu, %.3f to %.3f m long\n", summary.steps.size(),
                   summary.step_length_min_m, summary.step_length_max_m);
}

}  // namespace

std::string plant_text(const log::RunSummary& summary, simulation::Fall fall) {
  std::string text = summary.survived
                         ? formatted("result         on its feet after %.1f s\n", summary.duration_s)
                         : formatted("result         FELL at %.2f s: %s\n", summary.fall_time_s,
                                     simulation::fall_text(fall));
  const model::JointVector& torque = summary.peak_torque_Nm;
  const model::JointVector& speed = summary.peak_joint_speed_rad_s;
  text +=
      formatted("distance       %.2f m, mean speed %.3f m/s%s\n", summary.distance_m, summary.mean_speed_m_s,
                summary.duration_s > log::kSettled_s ? " after the first 3 s" : "");
  text += steps_line(summary);
  text += formatted("peak torque    hip_L %.1f, knee_L %.1f, hip_R %.1f, knee_R %.1f Nm\n", torque[0],
                    torque[1], torque[2], torque[3]);
  text += formatted("peak speed     hip_L %.1f, knee_L %.1f, hip_R %.1f, knee_R %.1f rad/s\n", speed[0],
                    speed[1], speed[2], speed[3]);
  return text + formatted("slip           %.3f m of both feet while loaded\n", summary.slip_distance_m);
}

std::string summary_text(const log::RunSummary& summary, simulation::Fall fall,
                         const control_loop::PlanTiming& timing) {
  std::string text = plant_text(summary, fall);
  const double tick_ms = 1e-6 * static_cast<double>(timing.tick_ns);
  text += formatted("plans          one every %g ms, in use %g ms after its state\n",
                    tick_ms * static_cast<double>(timing.period_ticks),
                    tick_ms * static_cast<double>(timing.delay_ticks));
  text +=
      formatted("planning       p50 %.0f, p99 %.0f, max %.0f us; %.1f iterations on average, %d at most\n",
                summary.solve_time_us.p50, summary.solve_time_us.p99, summary.solve_time_us.max,
                summary.sqp_iterations_mean, summary.sqp_iterations_max);
  text += formatted("memory         %lld heap allocations in the loop, controller object %.2f MB\n",
                    summary.heap_allocations_in_loop, 1e-6 * static_cast<double>(summary.controller_bytes));
  return text;
}

}  // namespace stilt::cli
