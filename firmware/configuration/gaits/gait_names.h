#pragma once

#include "mpc_core/model/types.h"

/// Names of the coordinates of a gait in gait files.
namespace stilt::gait_files {

inline constexpr const char* kJointKeys[model::kJoints] = {"stance_hip_rad", "stance_knee_rad",
                                                           "swing_hip_rad", "swing_knee_rad"};
inline constexpr const char* kPositionKeys[model::kPositions] = {
    "x_m", "z_m", "pitch_rad", "stance_hip_rad", "stance_knee_rad", "swing_hip_rad", "swing_knee_rad"};
inline constexpr const char* kTorqueKeys[model::kJoints] = {"stance_hip_Nm", "stance_knee_Nm", "swing_hip_Nm",
                                                            "swing_knee_Nm"};
inline constexpr const char* kForceKeys[2] = {"stance_force_x_N", "stance_force_z_N"};

}  // namespace stilt::gait_files
