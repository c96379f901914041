#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "firmware/supervisor/fallback.h"

/// Everything that can go wrong, as one table: what it is called, what is done, when it is over.
namespace stilt::supervisor {

/// The order is that of the table. Records and reports use name and number, which never change.
enum class Fault : std::uint8_t {
  joint_position_limit,
  joint_speed_limit,
  joint_torque_limit,
  base_pitch_limit,
  encoder_frozen,
  stale_torso_sensor,
  missed_replies,
  lost_replies,
  bus_error,
  bus_off,
  bus_disconnected,
  driver_fault,
  driver_not_enabled,
  driver_hot,
  driver_overheated,
  low_voltage,
  high_voltage,
  stale_plan,
  failed_solves,
  planner_overrun,
  torque_loop_overrun,
  torque_loop_stalled,
  not_finite,
  heartbeat_lost,
  emergency_stop,
  bring_up_failed,
  plan_missing,
  planner_lost,
  operator_gone,
  following_error,
  hip_height_limit,
  encoder_jump,
  torso_sensor_implausible,
  torque_mismatch,
};
inline constexpr std::size_t kFaults = 34;

/// What a fault means for what comes after.
enum class Severity : std::uint8_t {
  warning,   ///< reported, nothing changes
  degraded,  ///< the reaction lasts as long as the cause
  latched,   ///< the reaction stays until the operator resets it with every cause gone
};

/// When a fault is looked for.
enum class Watch : std::uint8_t {
  always,    ///< from idle on
  bring_up,  ///< in calibrate only
  driven,    ///< while drivers get commands: ready to sit, and fault
  torque,    ///< while joints may get more than damping: stand, step, walk, sit
  tracking,  ///< while the torque law is in command: stand, step, walk
};

/// What is done about a fault: a row of the table of faults.
struct FaultRow {
  Fault fault;
  int number;  ///< in records; never used for anything else
  const char* name;
  Severity severity;
  Reaction reaction;
  Watch watch;
  const char* cause;
  const char* clears;  ///< when the cause counts as gone
};

// clang-format off
inline constexpr std::array<FaultRow, kFaults> kFaultTable = {{
    {Fault::joint_position_limit, 101, "joint_position_limit", Severity::latched, Reaction::damp, Watch::driven,
     "a joint is beyond its travel by more than the margin", "every joint is within its travel and margin"},
    {Fault::joint_speed_limit, 102, "joint_speed_limit", Severity::latched, Reaction::damp, Watch::driven,
     "a joint is faster than its limit by more than the margin", "every joint is slower"},
    {Fault::joint_torque_limit, 103, "joint_torque_limit", Severity::latched, Reaction::damp, Watch::driven,
     "a driver reports more torque than the joint's limit and margin", "every driver reports less"},
    {Fault::base_pitch_limit, 104, "base_pitch_limit", Severity::latched, Reaction::damp, Watch::torque,
     "the torso leans too far: the robot falls", "the joints are damped, or the motors off"},
    {Fault::encoder_frozen, 201, "encoder_frozen", Severity::latched, Reaction::damp, Watch::tracking,
     "an encoder repeats one value though plan or gait move the joint", "the torque law is not in command"},
    {Fault::stale_torso_sensor, 202, "stale_torso_sensor", Severity::latched, Reaction::damp, Watch::driven,
     "the torso sensor is silent, or repeats one value while plan or gait move the joints", "a new angle came"},
    {Fault::missed_replies, 301, "missed_replies", Severity::degraded, Reaction::hold, Watch::driven,
     "a joint or the torso sensor missed several ticks in a row", "all have sent again"},
    {Fault::lost_replies, 302, "lost_replies", Severity::latched, Reaction::damp, Watch::driven,
     "a joint missed many ticks in a row", "all joints have sent again"},
    {Fault::bus_error, 303, "bus_error", Severity::warning, Reaction::warn, Watch::driven,
     "a bus reports errors or drops frames", "a tick without"},
    {Fault::bus_off, 304, "bus_off", Severity::latched, Reaction::damp, Watch::always,
     "the controller of a bus took itself off", "every bus is on"},
    {Fault::bus_disconnected, 305, "bus_disconnected", Severity::latched, Reaction::damp, Watch::always,
     "a bus is gone", "every bus is there"},
    {Fault::driver_fault, 401, "driver_fault", Severity::latched, Reaction::damp, Watch::driven,
     "a driver reports a fault", "no driver reports one"},
    {Fault::driver_not_enabled, 402, "driver_not_enabled", Severity::latched, Reaction::damp, Watch::driven,
     "a driver that should follow commands is idle", "every other cause is gone, since bring-up enables the driver"},
    {Fault::driver_hot, 403, "driver_hot", Severity::warning, Reaction::warn, Watch::driven,
     "a driver or motor is hot", "all are cooler"},
    {Fault::driver_overheated, 404, "driver_overheated", Severity::latched, Reaction::sit, Watch::driven,
     "a driver or motor is too hot", "all are cooler"},
    {Fault::low_voltage, 405, "low_voltage", Severity::latched, Reaction::sit, Watch::driven,
     "a driver reports too little supply voltage", "all report more"},
    {Fault::high_voltage, 406, "high_voltage", Severity::latched, Reaction::damp, Watch::driven,
     "a driver reports too much supply voltage", "all report less"},
    {Fault::stale_plan, 501, "stale_plan", Severity::latched, Reaction::sit, Watch::tracking,
     "there is no plan recent enough to follow, and no gait to track", "the torque law is not in command"},
    {Fault::failed_solves, 502, "failed_solves", Severity::warning, Reaction::warn, Watch::tracking,
     "several solves in a row gave no plan", "a solve gave a plan"},
    {Fault::planner_overrun, 503, "planner_overrun", Severity::warning, Reaction::warn, Watch::tracking,
     "a solve took longer than its limit", "a solve within it"},
    {Fault::torque_loop_overrun, 504, "torque_loop_overrun", Severity::warning, Reaction::warn, Watch::always,
     "a tick began later than its limit", "a tick in time"},
    {Fault::torque_loop_stalled, 505, "torque_loop_stalled", Severity::latched, Reaction::damp, Watch::driven,
     "the torque loop stood still for several ticks", "a tick in time"},
    {Fault::not_finite, 506, "not_finite", Severity::latched, Reaction::damp, Watch::tracking,
     "estimate or command is not a finite number, or the bus refused the command", "the torque law is not in command"},
    {Fault::heartbeat_lost, 601, "heartbeat_lost", Severity::degraded, Reaction::slow, Watch::tracking,
     "the operator's program is silent, or stiltd beside its loops stands still", "it sends again; a new command is needed to step again"},
    {Fault::emergency_stop, 602, "emergency_stop", Severity::latched, Reaction::damp, Watch::always,
     "the emergency stop is pressed, or silent", "it reports that it is released"},
    {Fault::bring_up_failed, 603, "bring_up_failed", Severity::latched, Reaction::off, Watch::bring_up,
     "a driver could not be brought up", "the next attempt begins"},
    {Fault::plan_missing, 507, "plan_missing", Severity::warning, Reaction::warn, Watch::tracking,
     "there is no plan recent enough to follow and in step: the joints track a gait instead", "a plan in step with the gait came"},
    {Fault::planner_lost, 508, "planner_lost", Severity::latched, Reaction::sit, Watch::tracking,
     "no plan came for so long that the robot shall not go on", "a plan came, or the torque law is not in command"},
    {Fault::operator_gone, 604, "operator_gone", Severity::latched, Reaction::sit, Watch::tracking,
     "the operator's program is silent for so long that the operator may be absent", "a command came"},
    {Fault::following_error, 105, "following_error", Severity::latched, Reaction::damp, Watch::torque,
     "a joint stays far from where plan, gait or sitting down has it", "the joints are damped, or the motors off"},
    {Fault::hip_height_limit, 106, "hip_height_limit", Severity::latched, Reaction::damp, Watch::tracking,
     "the hip is too near to the lower foot: the legs fold", "the torque law is not in command"},
    {Fault::encoder_jump, 203, "encoder_jump", Severity::latched, Reaction::damp, Watch::torque,
     "an encoder's angle and rate do not belong together", "the joints are damped, or the motors off"},
    {Fault::torso_sensor_implausible, 204, "torso_sensor_implausible", Severity::latched, Reaction::damp, Watch::tracking,
     "the torso sensor's angle and rate do not belong together", "the torque law is not in command"},
    {Fault::torque_mismatch, 407, "torque_mismatch", Severity::latched, Reaction::damp, Watch::torque,
     "a driver reports a torque far from the one it was asked for", "the joints are damped, or the motors off"},
}};
// clang-format on

[[nodiscard]] constexpr const FaultRow& row(Fault fault) noexcept {
  return kFaultTable[static_cast<std::size_t>(fault)];
}
[[nodiscard]] constexpr const char* name(Fault fault) noexcept { return row(fault).name; }

/// Any number of faults. Bit n is the fault in row n of the table.
class FaultSet {
 public:
  constexpr FaultSet() noexcept = default;
  constexpr explicit FaultSet(std::uint64_t bits) noexcept : bits_(bits) {}

  constexpr void add(Fault fault) noexcept { bits_ |= bit(fault); }
  constexpr void add_if(bool present, Fault fault) noexcept {
    if (present) add(fault);
  }
  [[nodiscard]] constexpr bool has(Fault fault) const noexcept { return (bits_ & bit(fault)) != 0; }
  [[nodiscard]] constexpr bool empty() const noexcept { return bits_ == 0; }
  [[nodiscard]] constexpr int count() const noexcept { return std::popcount(bits_); }
  [[nodiscard]] constexpr std::uint64_t bits() const noexcept { return bits_; }

  [[nodiscard]] constexpr FaultSet operator|(FaultSet other) const noexcept {
    return FaultSet(bits_ | other.bits_);
  }
  [[nodiscard]] constexpr FaultSet operator&(FaultSet other) const noexcept {
    return FaultSet(bits_ & other.bits_);
  }
  /// Those that are not in `other`.
  [[nodiscard]] constexpr FaultSet operator-(FaultSet other) const noexcept {
    return FaultSet(bits_ & ~other.bits_);
  }
  [[nodiscard]] constexpr bool operator==(const FaultSet&) const noexcept = default;

 private:
  [[nodiscard]] static constexpr std::uint64_t bit(Fault fault) noexcept {
    return std::uint64_t{1} << static_cast<unsigned>(fault);
  }
  std::uint64_t bits_ = 0;
};

/// Those of a severity.
[[nodiscard]] constexpr FaultSet of_severity(Severity severity) noexcept {
  FaultSet set;
  for (const FaultRow& fault : kFaultTable) set.add_if(fault.severity == severity, fault.fault);
  return set;
}

/// Those looked for on this occasion.
[[nodiscard]] constexpr FaultSet watched(Watch watch) noexcept {
  FaultSet set;
  for (const FaultRow& fault : kFaultTable) set.add_if(fault.watch == watch, fault.fault);
  return set;
}

/// Those that no reset waits for: bring-up ends their cause.
inline constexpr FaultSet kEndedByBringUp = [] {
  FaultSet set;
  set.add(Fault::driver_not_enabled);
  return set;
}();

/// The hardest reaction that any of the faults asks for.
[[nodiscard]] constexpr Reaction reaction(FaultSet faults) noexcept {
  Reaction hardest = Reaction::none;
  for (const FaultRow& fault : kFaultTable) {
    if (faults.has(fault.fault) && fault.reaction > hardest) hardest = fault.reaction;
  }
  return hardest;
}

}  // namespace stilt::supervisor
