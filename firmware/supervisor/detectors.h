#pragma once

#include <cstdint>

#include "firmware/supervisor/fallback.h"
#include "firmware/supervisor/fault.h"
#include "firmware/supervisor/parameters.h"
#include "firmware/supervisor/signal_monitor.h"
#include "hal/robot/joint_bus.h"
#include "hal/robot/robot.h"
#include "hal/sensors/emergency_stop.h"
#include "hal/sensors/torso_sensor.h"

/// Pure functions from what a tick has to faults. Every one is real-time. NaN never passes for healthy
/// where a value must be there, and never counts where a driver need not report it (temperature, voltage,
/// torque).
namespace stilt::supervisor {

/// What a tick has before the torque law runs. Times are those of the torque loop's clock.
struct Observation {
  std::int64_t time_ns = 0;
  hal::JointReadings joints;
  hal::BaseReading base;
  hal::JointBusStatus read_status = hal::JointBusStatus::ok;
  hal::JointBusStatus write_status = hal::JointBusStatus::ok;  ///< of the last tick's commands
  bool bus_errors = false;  ///< counters of errors, drops or malformed frames rose since the last tick
  hal::BusStates buses;     ///< which they are
  hal::EmergencyStopState emergency_stop = hal::EmergencyStopState::absent;
  hal::JointValues planned_speed_rad_s{};  ///< of plan or gait at this time, 0 while neither is followed
  Signals signals;                         ///< 0 while the joints get no torque but damping
  double hip_height_share = 1.0;           ///< hip above the lower foot, of the straight leg
  bool controller_finite = true;           ///< estimate and torques of the last tick were finite numbers
  Followable followable;                   ///< plan and gait
  int failed_solves = 0;                   ///< in a row
  double solve_s = 0;                      ///< of the newest solve
  double plan_age_s = 0;            ///< of the newest plan; without one since the robot got on its feet
  double wakeup_latency_s = 0;      ///< of this tick
  double tick_gap_s = 0;            ///< since the start of the tick before
  bool heartbeat_expected = false;  ///< of an operator's program, or of stiltd beside its loops
  double heartbeat_age_s = 0;       ///< since its last sign of life
  bool bring_up_failed = false;
};

/// How long the torque loop stood still, asleep or inside a tick.
[[nodiscard]] constexpr double stall_s(const Observation& seen) noexcept {
  return seen.wakeup_latency_s > seen.tick_gap_s ? seen.wakeup_latency_s : seen.tick_gap_s;
}

/// Beyond travel, speed or torque by more than the margins, or not finite; the torso too far from upright.
/// A joint without any reply has no position to judge. Legs that fold; joints far from where they should be.
[[nodiscard]] FaultSet detect_limits(const Observation& seen, const JointLimits& limits,
                                     const SupervisorParameters& parameters) noexcept;

/// An encoder repeats one value. That is right at rest alone.
[[nodiscard]] bool encoder_repeats(const hal::JointReading& joint,
                                   const SupervisorParameters& parameters) noexcept;

/// An encoder repeats one value though its joint should move at this speed.
[[nodiscard]] bool encoder_is_frozen(const hal::JointReading& joint, double planned_speed_rad_s,
                                     const SupervisorParameters& parameters) noexcept;

/// Sensors that repeat themselves, are silent, or contradict themselves.
[[nodiscard]] FaultSet detect_sensors(const Observation& seen,
                                      const SupervisorParameters& parameters) noexcept;

/// Largest difference between a joint's reported and asked torque, mean of 0.2 s.
[[nodiscard]] double torque_mismatch_limit_Nm(const Signals& signals, std::size_t joint,
                                              const SupervisorParameters& parameters) noexcept;

/// A joint's reported torque is far from the asked one, in Nm and as a share of it.
[[nodiscard]] bool torque_is_missing(const Signals& signals, std::size_t joint,
                                     const SupervisorParameters& parameters) noexcept;

/// Buses that err, are off, or gone.
[[nodiscard]] FaultSet detect_buses(const Observation& seen) noexcept;

/// Drivers with faults, not enabled, hot, badly supplied, or with another torque than asked for.
[[nodiscard]] FaultSet detect_drivers(const Observation& seen,
                                      const SupervisorParameters& parameters) noexcept;

/// Plans that are old, failed or slow; late ticks; non-finite values.
[[nodiscard]] FaultSet detect_software(const Observation& seen,
                                       const SupervisorParameters& parameters) noexcept;

/// Emergency stop and heartbeat; the outcome of the bring-up.
[[nodiscard]] FaultSet detect_operator(const Observation& seen,
                                       const SupervisorParameters& parameters) noexcept;

/// All of the above.
[[nodiscard]] FaultSet detect(const Observation& seen, const JointLimits& limits,
                              const SupervisorParameters& parameters) noexcept;

}  // namespace stilt::supervisor
