#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/diagnostics/black_box.h"
#include "firmware/supervisor/supervisor.h"
#include "hal/base_sensor.h"
#include "hal/joint_bus.h"

namespace stilt::diagnostics {

inline constexpr std::size_t kStates = 14;

/// What the torque loop knew and did in one tick. Fixed size, no pointers: for the black box and telemetry.
struct TickRecord {
  std::uint64_t tick = 0;    ///< counts from 0
  std::int64_t time_ns = 0;  ///< of the torque loop's clock, at the start of the tick
  hal::JointReadings joints;
  hal::BaseReading base;
  std::array<double, kStates> estimated_state{};  ///< [q; v], see mpc_core/model/types.h
  hal::JointCommands wanted;                      ///< of the torque law
  hal::JointCommands sent;                        ///< what left, when the action was `commands`
  supervisor::Action action = supervisor::Action::silent;
  supervisor::State state = supervisor::State::boot;
  supervisor::Rung rung = supervisor::Rung::off;
  supervisor::Reaction reaction = supervisor::Reaction::none;
  supervisor::FaultSet present;
  supervisor::FaultSet latched;
  double ramp = 0;
  long long plan_sequence = -1;    ///< of the plan in use
  double plan_age_s = 0;           ///< since the state it started from
  std::int64_t wakeup_ns = 0;      ///< lateness of this tick
  std::int64_t execution_ns = 0;   ///< duration of the tick before
  std::int64_t round_trip_ns = 0;  ///< newest from command to last reply
};

/// Two seconds at 1 kHz.
inline constexpr std::size_t kBlackBoxRecords = 2000;
using TickBlackBox = BlackBox<TickRecord, kBlackBoxRecords>;

}  // namespace stilt::diagnostics
