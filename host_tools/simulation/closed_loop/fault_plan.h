#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

/// Faults of the simulated robot on request: what breaks, where, when and for how long.
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
  power_cycle,
  low_voltage,
  over_temperature,
  emergency_stop,
  base_silent,
  base_freeze,
};

/// What a fault can affect.
enum class FaultTarget {
  frames,   ///< those of one joint, of one bus, or all
  bus,      ///< one bus
  joint,    ///< one joint's driver
  drivers,  ///< one joint's driver, those on one bus, or all
  robot,    ///< the whole robot
};

/// One row of the table of faults: what `--fault NAME...` accepts.
struct FaultDescription {
  FaultKind kind;
  const char* name;
  FaultTarget target;
  bool needs_bus;             ///< affects frames or buses; a plant without them cannot have it
  double default_duration_s;  ///< infinite: to the end of the run
  const char* description;
};

[[nodiscard]] std::span<const FaultDescription> fault_table();
[[nodiscard]] const FaultDescription& describe(FaultKind kind);
/// Which faults a robot can have.
enum class FaultsOf { plant, robot_on_buses };
/// The table as text, one fault per line.
[[nodiscard]] std::string describe_faults(FaultsOf which);

/// A fault with its time, counted from the moment the gantry has released the robot.
struct TimedFault {
  FaultKind kind = FaultKind::drop;
  std::optional<std::size_t> bus;    ///< only there
  std::optional<std::size_t> joint;  ///< only there
  double start_s = 0.0;
  double duration_s = 0.0;

  [[nodiscard]] bool active(double time_s) const {
    constexpr double kRounding_s = 1e-7;  // of times counted in ticks
    return time_s > start_s - kRounding_s && time_s < start_s + duration_s - kRounding_s;
  }
  /// Whether it affects a joint that is on a bus, or, without a joint, what else is on that bus.
  [[nodiscard]] bool affects(std::size_t on_bus, std::optional<std::size_t> at_joint) const {
    return (!bus || *bus == on_bus) && (!joint || joint == at_joint);
  }
};

/// Reads NAME[:TARGET]@START[+DURATION]; TARGET is a joint (hip_L, knee_L, hip_R, knee_R) or the number of a
/// bus. Throws std::invalid_argument, one sentence, when the text is something else.
[[nodiscard]] TimedFault parse_fault(std::string_view text);

/// hip_L, knee_L, hip_R, knee_R.
[[nodiscard]] const char* joint_name(std::size_t joint);

}  // namespace stilt::simulation
