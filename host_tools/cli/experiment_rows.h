#pragma once

#include <string>
#include <vector>

#include "host_tools/cli/experiment_walks.h"

namespace stilt::cli {

/// One row of `experiment disturbance`, from options or from a file of rows.
struct RowChoice {
  std::string name;  ///< letters, digits, '.', '-', '_'
  WalkSetting setting;
  std::string gait = "walk";
  double speed_m_s = 0.5;
  std::string direction = "forward";
  int phases = 8;
  int seeds = 3;
  double coarse_N = 10.0;
};

/// Largest speed of a row, in both directions.
inline constexpr double kLargestRowSpeed_m_s = 5.0;

/// Reads the rows of a TOML file, an array of tables [[row]]. A row has `name` and any of these keys:
///
///   robot, controller, horizon_s, preset, set, plant, gaits, lump, push_at, direction, gait, speed_m_s,
///   plan_rate_hz, plan_delay_s, state, phases, seeds, coarse_N
///
/// `defaults` gives the missing keys; the lists set and plant
/// are appended to its lists. All values are checked. Throws UsageError, one sentence with file, row and key.
[[nodiscard]] std::vector<RowChoice> read_rows(const std::string& file, const RowChoice& defaults);

}  // namespace stilt::cli
