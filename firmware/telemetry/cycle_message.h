#pragma once

#include "firmware/control_loop/cycle_record.h"
#include "firmware/telemetry/messages.h"

/// A solve of the planner as its record and as its message. Ordinary threads.
namespace stilt::telemetry {

/// `run_id` and `dropped` stay 0.
[[nodiscard]] PlannerCycle cycle_message(const control_loop::CycleRecord& record) noexcept;

/// The record, bit for bit what cycle_message() was given.
[[nodiscard]] control_loop::CycleRecord cycle_record(const PlannerCycle& message) noexcept;

}  // namespace stilt::telemetry
