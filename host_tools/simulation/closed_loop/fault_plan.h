#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

/// Injected faults of the simulated robot: what fails, where, when and for how long.
namespace stilt::simulation {

enum class FaultKind {
  drop,
  delay,
  duplicate,
  corrupt,
  bus_off,
  disconnect,
  driver_fault,
  encoder_freeze,
  torque_loss,
  power_cycle,
  low_voltage,
  over_temperature,
  emergency_stop,
  base_silent,
  base_freeze,
};

/// Target of a fault.
enum class FaultTarget {
  frames,   ///< frames of one joint, of one bus, or all
  bus,      ///< one bus
  joint,    ///< one joint's driver
  drivers,  ///< driver of one joint, drivers on one bus, or all drivers
  robot,    ///< the whole robot
};

/// One row of the table of faults: what `--fault NAME...` accepts.
struct FaultDescription {
  FaultKind kind;
  const char* name;
  FaultTarget target;
  bool needs_bus;             ///< affects frames or buses; not available for a plant without them
  double default_duration_s;  ///< infinite: until the end of the run
  const char* description;
};

[[nodiscard]] std::span<const FaultDescription> fault_table();
[[nodiscard]] const FaultDescription& describe(FaultKind kind);
/// Selects the faults that a robot can have.
enum class FaultsOf { plant, robot_on_buses };
/// The table as text, one fault per line.
[[nodiscard]] std::string describe_faults(FaultsOf which);

/// A fault with its time, counted from the release by the gantry.
struct TimedFault {
  FaultKind kind = FaultKind::drop;
  std::optional<std::size_t> bus;    ///< none: all buses
  std::optional<std::size_t> joint;  ///< none: all joints
  double start_s = 0.0;
  double duration_s = 0.0;

  [[nodiscard]] bool active(double time_s) const {
    constexpr double kRounding_s = 1e-7;  // of times counted in ticks
    return time_s > start_s - kRounding_s && time_s < start_s + duration_s - kRounding_s;
  }
  /// Whether the fault affects a joint on a bus, or, without a joint, the rest of that bus.
  [[nodiscard]] bool affects(std::size_t on_bus, std::optional<std::size_t> at_joint) const {
    return (!bus || *bus == on_bus) && (!joint || joint == at_joint);
  }
};

/// Parses NAME[:TARGET]@START[+DURATION]. TARGET is a joint (hip_L, knee_L, hip_R, knee_R) or the number of a
/// bus. Throws std::invalid_argument, one sentence, for any other text.
[[nodiscard]] TimedFault parse_fault(std::string_view text);

/// hip_L, knee_L, hip_R, knee_R.
[[nodiscard]] const char* joint_name(std::size_t joint);

}  // namespace stilt::simulation
