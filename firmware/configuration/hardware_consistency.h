#pragma once

#include <string>
#include <vector>

#include "firmware/configuration/consistency.h"
#include "firmware/configuration/hardware.h"
#include "firmware/configuration/runtime.h"
#include "firmware/supervisor/parameters.h"

namespace stilt::configuration {

/// Contradictions of the wiring: joints on buses that do not exist, drivers that share an identifier,
/// identifiers and ranges their protocol does not have. Those of check_torso_sensor() are among them.
void check_hardware(const HardwareParameters& hardware, std::vector<Contradiction>& found);

/// No sensor of the pitch, or settings of one that contradict one another. Also a rate that would be too
/// coarse, or whose window holds too few pitches.
void check_torso_sensor(const HardwareParameters& hardware, std::vector<Contradiction>& found);

/// Angles before base_pitch_limit, and rates on the way there, that the frames of the torso sensor cannot
/// carry. They would read less, and a fall would not be seen.
void check_torso_range(const HardwareParameters& hardware, const supervisor::SupervisorParameters& supervisor,
                       std::vector<Contradiction>& found);

/// Nodes of one bus whose frames would be taken for each other's: drivers among themselves, and drivers and
/// torso sensor. Also channels that share bits of a frame. Supposes a wiring that is valid in all else.
void check_identifiers(const HardwareParameters& hardware, std::vector<Contradiction>& found);

/// A sentence about two buses with the same identifiers of drivers, and no frame of a sensor that
/// distinguishes them. A scan finds everything in its place also where their adapters are exchanged. Empty:
/// there are none.
[[nodiscard]] std::string exchangeable_buses(const HardwareParameters& hardware);

/// Gains of the supervisor (hold, sit, damp) that the drivers cannot give. A command would carry the most
/// they give instead, or of a gain of few steps less, down to 0. The robot would sink or fall undamped. MIT
/// mode: ranges of the command; moteus: scales from 0 to 1 of the gains in its own configuration. ODrives
/// take torques only: CanRobot computes their law.
void check_gains(const HardwareParameters& hardware, const supervisor::SupervisorParameters& supervisor,
                 std::vector<Contradiction>& found);

/// A low voltage that drivers cannot report: every reading would be below it, and the robot would sit down.
void check_supply(const HardwareParameters& hardware, const supervisor::SupervisorParameters& supervisor,
                  std::vector<Contradiction>& found);

/// Contradictions between settings of the supervisor: each mild reaction must come before the hard one, and a
/// gait that is selected must be tracked. The gains of sitting must grow early in its motion.
void check_supervisor(const supervisor::SupervisorParameters& supervisor, std::vector<Contradiction>& found);

/// Contradictions between the threads. Between planner and torque loop there is one priority more, that of
/// the threads of adapters and torso sensors at serial ports.
void check_runtime(const RuntimeParameters& runtime, std::vector<Contradiction>& found);

}  // namespace stilt::configuration
