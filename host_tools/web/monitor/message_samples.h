#pragma once

#include "firmware/telemetry/messages.h"
#include "host_tools/web/monitor/samples.h"

/// Conversion of each message of stiltd to the sample that a monitor shows.
namespace stilt::monitor {

/// Whether every number of an enumeration is one of its enumerators. Others may come from anybody.
[[nodiscard]] bool well_formed(const telemetry::PlannerCycle& message) noexcept;
[[nodiscard]] bool well_formed(const telemetry::Supervisor& message) noexcept;

[[nodiscard]] PlannerSample planner_sample(const telemetry::PlannerCycle& message);

/// As many nodes as all sequences contain; none when their lengths are inconsistent.
[[nodiscard]] PlanSample plan_sample(const telemetry::Plan& message);

[[nodiscard]] SupervisorSample supervisor_sample(const telemetry::Supervisor& message);
[[nodiscard]] EventSample event_sample(const telemetry::Event& message);
[[nodiscard]] TimingSample timing_sample(const telemetry::Timing& message);

/// Leaves `run_id` empty.
[[nodiscard]] ConfigurationSample configuration_sample(const telemetry::ActiveConfiguration& message);

}  // namespace stilt::monitor
