#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "firmware/control_loop/control_loop.h"
#include "firmware/control_loop/planner_task.h"
#include "firmware/control_loop/start_script.h"
#include "firmware/diagnostics/statistics.h"
#include "firmware/exchange/latest_value.h"
#include "firmware/program/options.h"
#include "firmware/program/outcome.h"
#include "firmware/torso_sensor/serial_torso_sensor.h"
#include "hal/robot/lockstep_bus.h"
#include "hal/robot/robot_hardware.h"

namespace stilt::telemetry {
class TelemetryNode;
}

namespace stilt::program {

using diagnostics::LoopStatistics;
using diagnostics::PlannerStatistics;

/// All state of the controller: one object of fixed size, placed statically, which nothing outgrows. Its
/// parts belong to the threads that use them; what crosses between threads goes through the mailboxes.
struct ControllerState {
  control_loop::Mailboxes mail;
  control_loop::ControlLoop control;
  control_loop::PlannerTask planner;
  std::optional<control_loop::StartScript> script;
  control_loop::TickRecord newest_tick;  ///< that housekeeping has
  std::int64_t start_ns = 0;             ///< time of the first tick, known to housekeeping
  std::array<hal::LockstepBus, hal::kMaximumBuses> lockstep_buses;
  torso_sensor::SerialTorsoSensor serial_torso_sensor;  ///< started where the configuration has one
  std::optional<hal::RobotHardware> hardware;
  std::function<void(std::size_t bus)>
      reconnect;            ///< housekeeping connects a bus again, set by who opened it
  gait::GaitLibrary gaits;  ///< shipped for the robot; loaded at start, then constant
  telemetry::TelemetryNode* telemetry_node = nullptr;  ///< housekeeping's; nullptr: no telemetry
  LoopStatistics loop;
  PlannerStatistics planning;
  exchange::LatestValue<LoopStatistics> loop_statistics;
  exchange::LatestValue<PlannerStatistics> planner_statistics;
};

/// Puts the controller of a configuration together over open buses. In lock-step the sync frames are taken
/// off them. The error is one sentence for the user. Start-up only.
[[nodiscard]] std::expected<void, std::string> set_up(const Options& options,
                                                      std::span<hal::FrameBus* const> buses,
                                                      ControllerState& state);

/// The operator's side: takes the records of the torque loop, and lets the script or the operator at the
/// host command it. Without an operator at the host its own sign of life is the heartbeat.
void operate(ControllerState& state);

/// Housekeeping's part of a reset: connects buses again that the torque loop found gone.
void restore_buses(ControllerState& state);

/// After a solve of the planner's thread: plan and result go to the torque loop, the cycle is recorded and
/// counted. Real-time.
/// @param fresh  returned by PlannerTask::plan()
void finish_cycle(ControllerState& state, const control_loop::PlanningRequest& request, bool fresh,
                  std::int64_t solve_ns) noexcept;

/// Telemetry's turn: sends what is due.
void publish(ControllerState& state, const LoopStatistics& loop, const PlannerStatistics& planning);

/// Publishes what is left, after the last tick.
void flush_telemetry(ControllerState& state);

/// After a run that was not stopped: whether --start got where it was asked to go. Else the outcome has an
/// error.
void check_goal(const Options& options, const ControllerState& state, Outcome& outcome);

/// The results of a run that has ended.
void take_statistics(const ControllerState& state, Outcome& outcome);

}  // namespace stilt::program
