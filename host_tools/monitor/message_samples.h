#pragma once

#include <cstdint>

#include "firmware/control_loop/tick_record.h"
#include "firmware/telemetry/messages.h"
#include "host_tools/monitor/samples.h"

/// Each message of stiltd as what a monitor shows of it.
namespace stilt::monitor {

/// @param clock_start_ns  time_ns of tick 0
[[nodiscard]] TickSample tick_sample(const control_loop::TickRecord& record, std::int64_t clock_start_ns);

[[nodiscard]] PlannerSample planner_sample(const telemetry::PlannerCycle& message);

/// Knots as many as all its sequences have; none when they contradict each other.
[[nodiscard]] PlanSample plan_sample(const telemetry::Plan& message);

[[nodiscard]] SupervisorSample supervisor_sample(const telemetry::Supervisor& message);
[[nodiscard]] EventSample event_sample(const telemetry::Event& message);
[[nodiscard]] TimingSample timing_sample(const telemetry::Timing& message);

/// `session` is left empty.
[[nodiscard]] ConfigurationSample configuration_sample(const telemetry::ConfigurationInForce& message);

}  // namespace stilt::monitor
