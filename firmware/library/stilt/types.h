#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

/// Types of the library (docs/library.md). Numbers and text alone: no layout here depends on the instruction
/// set or on Eigen. SI units; frames and signs as in docs/conventions.md.
namespace stilt {

/// hip_L, knee_L, hip_R, knee_R: the order of all joints.
inline constexpr std::size_t kJointCount = 4;
/// x, z, pitch of the base, the joints, then their rates: the order of a state.
inline constexpr std::size_t kStateCount = 14;

inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// Readings of one joint in a tick. Unless position and velocity are both finite, there is no new reading.
struct JointMeasurement {
  double position_rad = kNotMeasured;
  double velocity_rad_s = kNotMeasured;
  double torque_Nm = 0.0;
};

/// Readings of the sensors in a tick.
struct Measurements {
  std::array<JointMeasurement, kJointCount> joints;
  double pitch_rad = kNotMeasured;  ///< of the torso, positive leans forward; not finite: no new reading
  double pitch_rate_rad_s = kNotMeasured;
  double left_foot_force_N = kNotMeasured;  ///< normal; NaN: no such sensor
  double right_foot_force_N = kNotMeasured;
  bool emergency_stop = false;
  bool drivers_enabled = true;  ///< the user's loop has brought up the four motor drivers
};

/// What a joint shall do: tau = torque_Nm + kp (position - q) + kd (velocity - v), within the torque limit.
struct JointTarget {
  double position_rad = 0.0;
  double velocity_rad_s = 0.0;
  double torque_Nm = 0.0;
  double kp_Nm_rad = 0.0;
  double kd_Nms_rad = 0.0;
  double torque_limit_Nm = 0.0;
};

using JointTargets = std::array<JointTarget, kJointCount>;

/// What the user's loop does with the drivers after a tick.
enum class DriverAction : std::uint8_t {
  none,     ///< send nothing
  enable,   ///< bring the drivers up; Measurements::drivers_enabled says when they are
  targets,  ///< send Tick::targets
  disable,  ///< disable all drivers
};

/// What an operator asks for. A robot on the gantry takes enable, then stand in the state ready, then the
/// rest.
enum class Motion : std::uint8_t {
  enable,  ///< bring the drivers up
  stand,
  step,
  walk,
  sit,
  reset,  ///< once the joints were damped: forget faults whose cause is gone
  off,    ///< walk, step, stand, sit, damp, then disable the drivers
  cut,    ///< disable the drivers at once: a standing robot falls
};

/// Result of a tick.
struct Tick {
  double time_s = 0.0;  ///< since the first tick
  DriverAction action = DriverAction::none;
  JointTargets targets;                             ///< with DriverAction::targets
  std::array<double, kStateCount> estimated_state;  ///< [q; v]
  const char* state = "";                           ///< of the supervisor: "walk", docs/controller.md
  const char* fallback_level = "";                  ///< what commands the joints: "plan"
  const char* fault =
      "";  ///< first of those that are present or wait for a reset, docs/troubleshooting.md; "": none
  double plan_age_s = 0.0;
  bool follows_plan = false;
};

/// A robot and its configuration.
struct Settings {
  std::string robot = {};  ///< a shipped one, or a URDF file; empty: that of the file, or amber3m
  std::string configuration_file = {};     ///< TOML; empty: the one shipped for the robot, or beside the URDF
  std::vector<std::string> settings = {};  ///< "section.key=value", after the file
};

}  // namespace stilt
