#pragma once

#include <string>

namespace stilt::configuration {

/// What stiltd publishes over DDS, and whose commands it takes (firmware/telemetry/README.md).
struct TelemetryParameters {
  bool enabled = true;
  std::string interface = "lo";
  int domain = 0;
  std::string peers = "none";            ///< "none", or addresses with commas between
  std::string security_folder = "none";  ///< "none", or where the documents of DDS Security are
  std::string token_file = "auto";       ///< "auto": see token.h in firmware/telemetry
  bool fixed_token = false;              ///< take the token from the file instead of writing a new one there
  double speed_limit_m_s = 0.8;          ///< of commands, of --start and of the library
  double release_s = 2.0;                ///< silence after which somebody is no longer the commander
  bool cmd_vel = false;                  ///< Twist changes the speed of a walk
  int ticks_per_batch = 25;              ///< ticks in a sample of the torque loop's record
  double joint_states_hz = 100.0;        ///< joint_states and odom
  double supervisor_hz = 20.0;
};

}  // namespace stilt::configuration
