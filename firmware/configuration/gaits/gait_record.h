#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "firmware/configuration/gaits/gait_limits.h"
#include "mpc_core/gait/hzd_gait.h"

namespace stilt::gait_files {

/// What a gait file claims of its gait. All of it can be computed anew from the rest of the file.
struct GaitMetrics {
  /// Largest error of the state (m, rad, m/s, rad/s) after integrating the equations of motion over one
  /// interval, under the file's inputs. The grid is four times finer than that of the optimisation.
  double defect_max = 0.0;
  /// Largest difference between the reduced state after impact and leg swap and that at the start (rad,
  /// rad/s).
  double periodicity_error = 0.0;
  /// Largest difference between joint angles of the motion and of the outputs, rad.
  double output_error_max_rad = 0.0;
  /// Largest difference between the file's torque curves and inverse dynamics, Nm.
  double torque_error_max_Nm = 0.0;
  /// Largest distance from the motion over five steps of the hybrid model under the gait's feedback (m, rad).
  double replay_error_max = 0.0;
  /// Magnitudes of the eigenvalues of the linearised return map, descending.
  double return_map_eigenvalues[gait::kReducedStates] = {};
  double peak_torque_Nm[model::kJoints] = {};          ///< stance hip, stance knee, swing hip, swing knee
  double peak_joint_speed_rad_s[model::kJoints] = {};  ///< same order
  double joint_position_margin_rad = 0.0;              ///< least distance to the ends of the joints' ranges
  double knee_min_rad = 0.0;
  double pitch_max_rad = 0.0;       ///< largest magnitude
  double friction_ratio_max = 0.0;  ///< |fx| / fz
  double normal_force_min_N = 0.0;
  double impulse_ratio = 0.0;        ///< |x| / z of the impulse at touch-down
  double clearance_m = 0.0;          ///< least height of the swing foot over the middle half of the step
  double swing_height_min_m = 0.0;   ///< least height of the swing foot from 5 % to 95 % of the step
  double touchdown_speed_m_s = 0.0;  ///< downward
  double touchdown_slip_m_s = 0.0;   ///< forward, of the foot that lands
  double torque_squared_per_m =
      0.0;  ///< N^2 m^2 s / m: integral of the squared torques / step length; 0 in place
};

/// One gait file.
struct GaitRecord {
  std::string robot;
  gait::HzdGait gait;
  GaitLimits limits;
  std::optional<GaitMetrics> claims;
  std::vector<std::pair<std::string, std::string>> origin;  ///< how it was made: key, text
};

/// A row of the tables of the file: one number or a few.
template <class T>
struct Field {
  const char* key;
  const char* meaning;
  std::span<double> (*values)(T&);
};

[[nodiscard]] std::span<const Field<GaitLimits>> limit_fields();
[[nodiscard]] std::span<const Field<GaitMetrics>> metric_fields();

}  // namespace stilt::gait_files
