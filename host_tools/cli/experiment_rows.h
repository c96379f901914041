#pragma once

#include <string>
#include <vector>

#include "host_tools/cli/experiment_walks.h"

namespace stilt::cli {

/// One row of `experiment disturbance`, from options or from a file of rows.
struct RowChoice {
  std::string name;  ///< letters, digits, point, minus, underscore
  WalkSetting setting;
  std::string gait = "walk";
  double speed_m_s = 0.5;
  std::string direction = "forward";
  int phases = 8;
  int seeds = 3;
  double coarse_N = 10.0;
};

/// Longest speed of a row, either way.
inline constexpr double kLargestRowSpeed_m_s = 5.0;

/// The rows of a TOML file: an array of tables [[row]] with `name` and any of robot, controller, horizon_s,
/// preset, set, plant, gaits, lump, push_at, direction, gait, speed_m_s, plan_rate_hz, plan_delay_s, state,
/// phases, seeds, coarse_N. A key that a row leaves out is that of `defaults`; what its lists set and plant
/// hold is added. Everything checked. Throws UsageError, one sentence that names file, row and key.
[[nodiscard]] std::vector<RowChoice> read_rows(const std::string& file, const RowChoice& defaults);

}  // namespace stilt::cli
