#pragma once

#include <string>
#include <vector>

#include "host_tools/experiments/job_folder.h"
#include "host_tools/experiments/walk_case.h"

namespace stilt::experiments {

/// Page and numbers of `stilt experiment figures`, computed from walks of the simulated robot.
struct FiguresResult {
  std::string page;  ///< HTML, complete in itself
  Json numbers;      ///< {push: {...}, recovery: [{...}], periodicity: [{controller, ...}]}
};

/// Computes the figures. One shows the push of 20 N for 1 s under mpc-heuristic (states, torques, contact
/// forces), with touch-downs and those of a push of 85 N (recovery_tiles.h). Others show postures and joint
/// angles of mpc-heuristic at 1.0 and 0.5 s and of mpc-hzd at 0.5 s. The last show the variation of the joint
/// angles from step to step, without and with sensor noise, and the ends of the plans. `duration_s`: duration
/// of each walk, at least 8 s.
[[nodiscard]] FiguresResult make_figures(const WalkRunner& run, double duration_s);

}  // namespace stilt::experiments
