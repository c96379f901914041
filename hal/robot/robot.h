#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "hal/bring_up/bring_up.h"
#include "hal/driver/driver_fault.h"
#include "hal/robot/joint_bus.h"
#include "hal/sensors/emergency_stop.h"
#include "hal/sensors/torso_sensor.h"

namespace stilt::hal {

/// Buses by their numbers in the wiring: bit n is bus n.
struct BusStates {
  std::uint8_t off = 0;     ///< their controllers took themselves off
  std::uint8_t gone = 0;    ///< disconnected
  std::uint8_t erring = 0;  ///< errors or lost frames since the read before
};

/// Newest reading of every channel. A channel without news keeps its values and counts what it missed.
struct RobotReadings {
  JointReadings joints;
  BaseReading base;
  JointBusStatus status = JointBusStatus::ok;
  EmergencyStopState emergency_stop = EmergencyStopState::absent;
  std::uint64_t bus_errors = 0;  ///< frames lost, withheld or malformed and error reports, since the start
  BusStates buses;
};

/// Progress of the motor drivers from powered to enabled.
struct BringUpProgress {
  bool ready = false;   ///< all four are enabled, at zero torque
  bool failed = false;  ///< one cannot be; the others are not asked any further
  /// The driver at work, or the one that failed, and where.
  std::size_t joint = 0;
  bring_up::Stage stage = bring_up::Stage::identify;
  bring_up::Failure failure = bring_up::Failure::none;
  DriverFault fault = DriverFault::none;
  std::uint32_t fault_code = 0;                         ///< vendor code of `fault`
  bring_up::Setting setting = bring_up::Setting::none;  ///< of the driver, when one is to blame
  double reply_lag_s = 0;                               ///< of the driver, with failure slow_reply
  std::uint32_t version = 0;                            ///< of the driver, with failure wrong_version
  std::uint32_t wanted_version = 0;                     ///< by the configuration, likewise
};

/// A robot as the control loop uses it: readings in, commands out. Implemented by motor drivers on CAN buses,
/// by the simulated plant, and by records. No call waits, allocates, locks or throws.
class Robot {
 public:
  /// Once per tick, first. Takes everything that has arrived.
  /// @param now_ns  CLOCK_MONOTONIC, stamps what carries no stamp of its own
  virtual void read(std::int64_t now_ns, RobotReadings& readings) noexcept = 0;

  /// Sends all four commands, in one batch per bus.
  [[nodiscard]] virtual JointBusStatus write(const JointCommands& commands) noexcept = 0;

  /// Disables every driver (idle, or its own safe state). Sent even after refused commands.
  [[nodiscard]] virtual JointBusStatus disable() noexcept = 0;

  /// Starts the bring-up of the drivers over, from whatever state they are in.
  virtual void begin_bring_up() noexcept = 0;

  /// One step of it, once per tick, instead of a command. Services the watchdogs of drivers that are ready
  /// with commands of zero torque.
  [[nodiscard]] virtual BringUpProgress bring_up(std::int64_t now_ns) noexcept = 0;

  /// The first joint whose driver was up, may have lost its power since, and counts from power-up: its offset
  /// is void until the end.
  [[nodiscard]] virtual std::optional<std::size_t> void_offset() const noexcept { return std::nullopt; }

  /// The operator asked for a reset: clears bus-off and faults that drivers keep, and has lost connections
  /// made again, later and elsewhere. Called every tick until that is over.
  virtual void restore_buses() noexcept = 0;

 protected:
  ~Robot() = default;
};

}  // namespace stilt::hal
