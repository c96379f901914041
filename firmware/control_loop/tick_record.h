#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/control_loop/messages.h"
#include "firmware/exchange/black_box.h"
#include "firmware/supervisor/supervisor.h"
#include "hal/robot/robot.h"

namespace stilt::control_loop {

/// Inputs and outputs of the torque loop in one tick: every input, so that a replay can run the tick again,
/// and every output. Fixed size, no pointers: for the black box and telemetry.
struct TickRecord {
  std::uint64_t tick = 0;    ///< counts from 0
  std::int64_t time_ns = 0;  ///< of the torque loop's clock, at the start of the tick
  hal::JointReadings joints;
  hal::BaseReading base;
  hal::JointBusStatus read_status = hal::JointBusStatus::ok;
  hal::JointBusStatus write_status = hal::JointBusStatus::ok;  ///< of this tick's commands
  hal::EmergencyStopState emergency_stop = hal::EmergencyStopState::absent;
  std::uint64_t bus_errors = 0;   ///< counter of all buses
  hal::BringUpProgress bring_up;  ///< newest of the drivers; changes in calibrate only
  OperatorCommand command;        ///< the operator's, active
  std::uint32_t tuning = 0;       ///< number of the active live tunables
  PlanningResult result;          ///< newest of the planner
  long long visible_plan = -1;    ///< sequence of the newest plan, whether or not it is used
  std::array<double, model::kStates> estimated_state{};  ///< [q; v], see mpc_core/model/types.h
  /// Before the supervisor acts: torques of the torque law or the gait tracker, 0 at other levels. Position
  /// and speed are those of plan, gait or the way to sit; the position is NaN where none of them leads the
  /// joints.
  hal::JointCommands wanted;
  hal::JointCommands sent;  ///< what left, when the action was `commands`
  supervisor::Action action = supervisor::Action::silent;
  supervisor::State state = supervisor::State::boot;
  supervisor::FallbackLevel level = supervisor::FallbackLevel::off;
  supervisor::Reaction reaction = supervisor::Reaction::none;
  supervisor::FaultSet present;
  supervisor::FaultSet latched;
  double ramp = 0;
  long long plan_sequence = -1;  ///< of the plan that is followed, -1: none
  /// Of the newest plan, since the state it started from; without one since the stance episode began. NaN
  /// outside of an episode.
  double plan_age_s = 0;
  std::uint32_t stance_episode = 0;    ///< counts the times the robot got on its feet; 0: no plan is wanted
  gait::GaitCommand gait;              ///< asked of the planner
  std::int64_t wakeup_latency_ns = 0;  ///< how late this tick began
  std::int64_t execution_ns = 0;       ///< duration of the tick before
  std::int64_t bus_round_trip_ns = 0;  ///< newest from command to last reply
};

/// Two seconds at 1 kHz.
inline constexpr std::size_t kBlackBoxRecords = 2000;
using TickBlackBox = exchange::BlackBox<TickRecord, kBlackBoxRecords>;

}  // namespace stilt::control_loop
