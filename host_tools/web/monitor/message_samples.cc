#include "host_tools/web/monitor/message_samples.h"

#include <algorithm>

#include "firmware/supervisor/fallback.h"
#include "firmware/supervisor/fault.h"
#include "firmware/supervisor/state.h"
#include "firmware/telemetry/cdr.h"
#include "mpc_core/gait/command.h"
#include "mpc_core/sqp/solve_status_names.h"

namespace stilt::monitor {
namespace {

using telemetry::span_of;

/// Copies upper edges and counts of the non-empty bins from their lower edges.
void copy_bins(const stilt_msgs_msg_dds__Histogram_& message, HistogramSample& sample) {
  const auto edges = span_of(message.lower_edge_us);
  const auto counts = span_of(message.bin);
  constexpr double kLastBin = 1.125;  // each bin covers an eighth of a factor of two
  for (std::size_t k = 0; k < std::min(edges.size(), counts.size()); ++k) {
    if (counts[k] == 0) continue;
    const double lower_us = static_cast<double>(edges[k]);
    sample.upper_edge_us.push_back(k + 1 < edges.size() ? static_cast<double>(edges[k + 1])
                                                        : lower_us * kLastBin);
    sample.in_bin.push_back(counts[k]);
  }
}

}  // namespace

bool well_formed(const telemetry::PlannerCycle& message) noexcept {
  return message.status < sqp::kSolveStatusNames.size();
}

bool well_formed(const telemetry::Supervisor& message) noexcept {
  return message.state < supervisor::kStates && message.fallback_level < supervisor::kFallbackLevels &&
         message.reaction < supervisor::kReactions &&
         message.gait <= static_cast<std::uint8_t>(gait::GaitKind::walk);
}

PlannerSample planner_sample(const telemetry::PlannerCycle& message) {
  PlannerSample sample;
  sample.cycle = message.cycle;
  sample.time_s = message.time_s;
  sample.status = message.status;
  sample.iterations = message.iterations;
  sample.dynamics_defect_max = message.dynamics_defect_max;
  sample.equality_violation_max = message.equality_violation_max;
  sample.violations.friction_cone_violation_max_N = message.friction_cone_violation_max_N;
  sample.violations.pulling_force_max_N = message.pulling_force_max_N;
  sample.violations.torque_violation_max_Nm = message.torque_violation_max_Nm;
  sample.cost = message.cost;
  sample.solve_us = 1e-3 * static_cast<double>(message.solve_ns);
  return sample;
}

PlanSample plan_sample(const telemetry::Plan& message) {
  PlanSample sample;
  sample.time_s = message.start_time_s;
  const auto times = span_of(message.time_s);
  const auto contacts = span_of(message.contact);
  const auto base = span_of(message.base);
  const auto feet = span_of(message.foot_position_m);
  const auto forces = span_of(message.contact_force_N);
  const std::size_t count = times.size();
  if (contacts.size() != count || base.size() != 3 * count || feet.size() != 4 * count ||
      forces.size() != 4 * count) {
    return sample;
  }
  for (std::size_t k = 0; k < count; ++k) {
    PlanNodeSample node;
    node.time_s = message.start_time_s + static_cast<double>(times[k]);
    node.base_x_m = static_cast<double>(base[3 * k]);
    node.base_z_m = static_cast<double>(base[3 * k + 1]);
    node.pitch_rad = static_cast<double>(base[3 * k + 2]);
    for (std::size_t i = 0; i < 4; ++i) {
      node.foot_position_m[i] = static_cast<double>(feet[4 * k + i]);
      node.contact_force_N[i] = static_cast<double>(forces[4 * k + i]);
    }
    node.left_stance = (contacts[k] & 1) != 0;
    node.right_stance = (contacts[k] & 2) != 0;
    sample.nodes.push_back(node);
  }
  return sample;
}

SupervisorSample supervisor_sample(const telemetry::Supervisor& message) {
  SupervisorSample sample;
  sample.time_s = message.time_s;
  sample.state = message.state;
  sample.fallback_level = message.fallback_level;
  sample.reaction = message.reaction;
  sample.present = message.present_faults;
  sample.latched = message.latched_faults;
  sample.ramp = message.ramp;
  sample.gait = message.gait;
  sample.speed_m_s = message.speed_m_s;
  sample.base_height_m = message.base_height_m;
  sample.commander = message.commander;
  sample.commander_alive = message.commander_alive;
  const auto names = span_of(message.faults);
  const auto found = span_of(message.found);
  for (std::size_t i = 0; i < std::min(names.size(), found.size()); ++i) sample.found[names[i]] = found[i];
  return sample;
}

EventSample event_sample(const telemetry::Event& message) {
  constexpr int kFault = 1, kBringUpFailed = 3;
  const bool fault = message.kind == kFault && message.fault < supervisor::kFaults;
  const bool warning =
      fault && supervisor::kFaultTable[message.fault].severity == supervisor::Severity::warning;
  return {message.time_s, message.text, (fault && !warning) || message.kind == kBringUpFailed, warning};
}

TimingSample timing_sample(const telemetry::Timing& message) {
  TimingSample sample;
  sample.ticks = message.ticks;
  sample.late_ticks = message.late_ticks;
  sample.dropped = message.dropped_ticks + message.dropped_cycles + message.dropped_events;
  for (const stilt_msgs_msg_dds__Histogram_& histogram : span_of(message.histograms)) {
    HistogramSample copy;
    copy.name = histogram.name;
    copy.deadline_us = histogram.deadline_us;
    copy.p50_us = histogram.p50_us;
    copy.p99_us = histogram.p99_us;
    copy.p999_us = histogram.p999_us;
    copy.max_us = histogram.max_us;
    copy.count = histogram.count;
    copy_bins(histogram, copy);
    sample.histograms.push_back(std::move(copy));
  }
  return sample;
}

ConfigurationSample configuration_sample(const telemetry::ActiveConfiguration& message) {
  ConfigurationSample sample;
  sample.robot = message.robot;
  sample.build = std::string(message.version) + ", " + message.compiler + ", " + message.instruction_set;
  if (message.lockstep) sample.build += ", lock-step";
  const std::string why_not = message.realtime;
  sample.build += why_not.empty() ? ", real time" : ", not real time: " + why_not;
  sample.toml = message.configuration;
  sample.tick_rate_hz = message.torque_rate_hz;
  sample.plan_rate_hz = message.plan_rate_hz;
  for (const stilt_msgs_msg_dds__Tunable_& tunable : span_of(message.tunables)) {
    sample.tunables.push_back({tunable.key, tunable.unit, tunable.description, tunable.minimum,
                               tunable.maximum, tunable.start_value});
  }
  return sample;
}

}  // namespace stilt::monitor
