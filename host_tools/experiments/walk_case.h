#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host_tools/recording/run_record.h"
#include "host_tools/simulation/closed_loop/scenario.h"
#include "mpc_core/gait/command.h"

/// The published experiments on the simulated robot. The caller passes the function that runs a walk, so that
/// this folder depends on neither options nor configuration.
namespace stilt::experiments {

/// One walk that starts standing at time 0.
struct WalkCase {
  std::string controller = "mpc-heuristic";
  double horizon_s = 1.0;
  gait::GaitCommand command{gait::GaitKind::walk, 0.5};
  std::vector<simulation::TimedCommand> later_commands;  ///< in order of time
  double duration_s = 10.0;
  double push_N = 0.0;  ///< positive forward; 0: none
  double push_start_s = 0.0;
  double push_duration_s = 1.0;
  double measure_from_s = 0.0;        ///< slip and time at the torque limit count from this time
  std::vector<std::string> settings;  ///< "section.key=value" of the configuration, applied after the user's
  std::vector<std::string> plant;     ///< "KEY=VALUE" of the simulated robot or its world, applied after the
                                      ///< user's
  std::uint64_t seed = 1;             ///< of the sensor noise
  double sensor_noise_scale = 1.0;    ///< factor on the noise of all sensors
  bool keep_samples = false;          ///< false: only the summary
  bool sample_every_tick = false;     ///< of control; false: as `stilt sim` samples
};

/// Runs a case. Throws when the case cannot be set up.
using WalkRunner = std::function<log::RunRecord(const WalkCase&)>;

}  // namespace stilt::experiments
