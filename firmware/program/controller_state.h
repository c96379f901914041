#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include "firmware/controller/planner_cycle.h"
#include "firmware/controller/start_script.h"
#include "firmware/controller/torque_cycle.h"
#include "firmware/diagnostics/histogram.h"
#include "firmware/exchange/latest_value.h"
#include "firmware/hardware/lockstep_bus.h"
#include "firmware/hardware/robot_hardware.h"
#include "firmware/program/options.h"
#include "firmware/program/outcome.h"

namespace stilt::program {

/// Figures of the torque loop; a copy goes to the housekeeping thread now and then.
struct LoopFigures {
  diagnostics::Histogram wakeup;
  diagnostics::Histogram execution;
  diagnostics::Histogram bus_round_trip;
  long long ticks = 0;
  long long late_ticks = 0;      ///< began later than supervisor.torque_loop_overrun_s
  long long missed_periods = 0;  ///< left out after an overrun
  long long heap_allocations = 0;
  long long page_faults = 0;
};

/// Figures of the planner.
struct PlannerFigures {
  diagnostics::Histogram solve;
  long long plans = 0;
  long long heap_allocations = 0;
  long long page_faults = 0;
};

/// All state of the controller: one object of fixed size, placed statically, which nothing outgrows. Its
/// parts belong to the threads that use them; what crosses between threads goes through the mailboxes.
struct ControllerState {
  controller::Mailboxes mail;
  controller::TorqueCycle torque;
  controller::PlannerCycle planner;
  std::optional<controller::StartScript> script;
  diagnostics::TickRecord newest_tick;  ///< that housekeeping knows of
  std::int64_t start_ns = 0;            ///< time of the first tick, known to housekeeping
  std::array<hardware::LockstepBus, hal::kMaximumBuses> lockstep_buses;
  std::optional<hardware::RobotHardware> hardware;
  bool black_box_saved = false;
  LoopFigures loop;
  PlannerFigures planning;
  exchange::LatestValue<LoopFigures> loop_figures;
  exchange::LatestValue<PlannerFigures> planner_figures;
};

/// Puts the controller of a configuration together over open buses. In lock-step the sync frames are taken
/// off them. The error is one sentence for the user. Start-up only.
[[nodiscard]] std::expected<void, std::string> set_up(const Options& options,
                                                      std::span<hal::FrameBus* const> buses,
                                                      ControllerState& state);

/// The operator's side: takes what the torque loop told of its ticks, and lets the script command it.
void operate(ControllerState& state, const std::atomic<bool>& stop);

/// The figures of a run that has ended.
void take_figures(const ControllerState& state, Outcome& outcome);

}  // namespace stilt::program
