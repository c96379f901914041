#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "firmware/control_loop/tick_record.h"
#include "mpc_core/ocp/violations.h"

/// Data that a monitor shows, from the live robot, a record or a test. SI units; time_s is the
/// controller's clock, seconds since its first tick. Ordinary threads.
namespace stilt::monitor {

/// One tick of the torque loop.
struct TickSample {
  double time_s = 0.0;
  control_loop::TickRecord record;
  double tick_rate_hz = 1000.0;  ///< as in ConfigurationSample
};

/// One cycle of the planner.
struct PlannerSample {
  std::uint64_t cycle = 0;  ///< increases by 1; a gap is a dropped cycle
  double time_s = 0.0;      ///< of the state it planned from
  int status = 0;           ///< number of sqp::SolveStatus
  int iterations = 0;
  double dynamics_defect_max = 0.0;     ///< mixed SI units
  double equality_violation_max = 0.0;  ///< m/s^2 or N
  ocp::Violations violations;           ///< of the inequalities
  double cost = 0.0;
  double solve_us = 0.0;  ///< 0 in lock-step
};

/// One node of a plan, for drawing it ahead of the robot.
struct PlanNodeSample {
  double time_s = 0.0;
  double base_x_m = 0.0, base_z_m = 0.0, pitch_rad = 0.0;
  std::array<double, 4> foot_position_m{};  ///< xL, zL, xR, zR
  std::array<double, 4> contact_force_N{};  ///< fxL, fzL, fxR, fzR, on the robot
  bool left_stance = false, right_stance = false;
};

/// A plan, as nodes for drawing.
struct PlanSample {
  double time_s = 0.0;  ///< of the state it starts from
  std::vector<PlanNodeSample> nodes;
};

/// State of the supervisor.
struct SupervisorSample {
  double time_s = 0.0;
  int state = 0;                             ///< number of supervisor::State
  int fallback_level = 0;                    ///< number of supervisor::FallbackLevel
  int reaction = 0;                          ///< number of supervisor::Reaction
  std::uint64_t present = 0;                 ///< bits of supervisor::FaultSet
  std::uint64_t latched = 0;                 ///< the same, waiting for a reset
  double ramp = 0.0;                         ///< progress of the blend-in of the torque law, 0 to 1
  int gait = 0;                              ///< active gait, number of gait::GaitKind
  double speed_m_s = 0.0;                    ///< active speed of walk
  double base_height_m = 0.0;                ///< active height of the hip; 0: unknown
  std::string commander;                     ///< who is in command; empty: none
  bool commander_alive = false;              ///< whether its heartbeat arrives
  std::map<std::string, std::string> found;  ///< by name of a fault: joint, driver, numbers, in words
};

/// An event; the text is one sentence.
struct EventSample {
  double time_s = 0.0;
  std::string text;
  bool serious = false;  ///< a fault that is more than a warning
  bool warning = false;
};

/// Histogram of durations.
struct HistogramSample {
  std::string name;
  double deadline_us = 0.0;  ///< 0: none
  double p50_us = 0.0, p99_us = 0.0, p999_us = 0.0, max_us = 0.0;
  std::uint64_t count = 0;
  std::vector<double>
      upper_edge_us;  ///< of the bins that hold something, ascending; infinity is written as 0
  std::vector<std::uint64_t> in_bin;  ///< one count per bin of upper_edge_us
};

/// Timing of the control loop and the planner.
struct TimingSample {
  std::uint64_t ticks = 0, late_ticks = 0;
  std::uint64_t dropped = 0;  ///< records for which the controller's rings had no room
  std::vector<HistogramSample> histograms;
};

/// A value that may change during a walk.
struct Tunable {
  std::string name;  ///< section.key
  std::string unit, description;
  double min = 0.0, max = 0.0, value = 0.0;
};

/// Description of the controller and its robot.
struct ConfigurationSample {
  std::string run_id;  ///< id of this run of the controller; empty: unknown
  std::string robot;   ///< amber3m, amber3m_2020, rabbit
  std::string build;   ///< version, compiler, instruction set
  std::string toml;    ///< active configuration
  double tick_rate_hz = 1000.0;
  double plan_rate_hz = 500.0;
  std::vector<Tunable> tunables;
};

/// Data that exist only in a simulation.
struct TruthSample {
  double time_s = 0.0;
  std::array<double, 4> contact_force_N{};  ///< fxL, fzL, fxR, fzR, on the robot
  double push_N = 0.0;                      ///< positive is forward
  double push_above_hip_m = 0.0;            ///< distance of its point from the hip along the torso
};

/// The robot's reply to a command.
struct ReplySample {
  std::uint64_t commander = 0;  ///< sender of the command
  std::uint32_t sequence = 0;   ///< number of the command, as counted by the sender
  bool accepted = false;
  std::string reason;  ///< reason for a refusal, one sentence
  /// Whether it proves the token of the command. A refusal that does not is somebody's: of a robot with
  /// another token, or forged. The robot's own reply may follow.
  bool proven = true;
};

}  // namespace stilt::monitor
