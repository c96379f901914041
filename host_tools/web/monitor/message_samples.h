#pragma once

#include "firmware/telemetry/messages.h"
#include "host_tools/web/monitor/samples.h"

/// Each message of stiltd as what a monitor shows of it.
namespace stilt::monitor {

[[nodiscard]] PlannerSample planner_sample(const telemetry::PlannerCycle& message);

/// Knots as many as all its sequences have; none when they contradict each other.
[[nodiscard]] PlanSample plan_sample(const telemetry::Plan& message);

[[nodiscard]] SupervisorSample supervisor_sample(const telemetry::Supervisor& message);
[[nodiscard]] EventSample event_sample(const telemetry::Event& message);
[[nodiscard]] TimingSample timing_sample(const telemetry::Timing& message);

/// `run_id` is left empty.
[[nodiscard]] ConfigurationSample configuration_sample(const telemetry::ConfigurationInForce& message);

}  // namespace stilt::monitor
