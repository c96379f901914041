#pragma once

#include <atomic>
#include <cstdint>

#include "firmware/supervisor/supervisor.h"
#include "mpc_core/control/planner_settings.h"
#include "mpc_core/gait/command.h"
#include "mpc_core/model/types.h"
#include "mpc_core/sqp/solve_report.h"

/// What the threads of the controller hand each other.
namespace stilt::control_loop {

/// Operator -> torque loop.
struct OperatorCommand {
  supervisor::Request request;
  bool shut_down = false;  ///< end the program: sit, damp, disable the drivers
  bool heartbeat_expected =
      false;  ///< somebody is to be alive: a commander, without one housekeeping of stiltd
  std::int64_t heartbeat_ns = 0;  ///< its last sign of life, clock of the torque loop
};

/// What signals ask of the program: a handler sets them, and the torque loop takes them in every tick. So
/// nothing that housekeeping waits for, a terminal or a disk, delays a stop.
struct StopSignals {
  static_assert(std::atomic<bool>::is_always_lock_free, "signal handlers set them");
  std::atomic<bool> shut_down = false;  ///< sit, damp, disable the drivers, end
  std::atomic<bool> cut = false;        ///< disable the drivers at once, end

  /// The command with what the signals ask for. Real-time.
  [[nodiscard]] OperatorCommand merged_into(OperatorCommand command) const noexcept {
    if (shut_down.load(std::memory_order_relaxed)) command.shut_down = true;
    if (cut.load(std::memory_order_relaxed)) command.request.kind = supervisor::RequestKind::cut;
    return command;
  }
};

/// Live tunables that the torque loop uses; operator -> torque loop.
struct TorqueTuning {
  std::uint32_t number = 0;  ///< counts changes of live tunables; 0: the configuration
  control::TorqueLawParameters law;
};

/// Live tunables that the planner uses; operator -> planner.
struct PlannerTuning {
  std::uint32_t number = 0;  ///< as above
  control::PlannerSettings settings;
};

/// Torque loop -> planner, every tick.
struct PlanningRequest {
  std::int64_t tick = -1;
  double time_s = 0.0;               ///< of the state, controller's clock
  std::uint32_t stance_episode = 0;  ///< counts the times the robot got on its feet; 0: no plan is wanted
  model::StateVector state = model::StateVector::Zero();
  gait::GaitCommand command;
  gait::TrackedStep tracked;  ///< the step of the gait that commands the joints
};

/// Planner -> torque loop, after every cycle.
struct PlanningResult {
  std::uint64_t cycles = 0;             ///< solves since the start
  std::uint32_t failures_in_a_row = 0;  ///< solves without a usable plan
  std::uint32_t stance_episode = 0;     ///< of the request it answers
  std::int64_t solve_ns = 0;            ///< duration of the newest solve; 0 in lock-step
  sqp::SolveStatus status = sqp::SolveStatus::iteration_limit;
};

}  // namespace stilt::control_loop
