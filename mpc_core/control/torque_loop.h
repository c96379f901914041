#pragma once

#include "mpc_core/control/parameters.h"
#include "mpc_core/control/plan.h"
#include "mpc_core/model/robot.h"

namespace stilt::control {

/// What the sensors give at one tick: four joint encoders and the angle of the base.
struct SensorReading {
  double time_s = 0.0;
  model::JointVector joint_position_rad;
  model::JointVector joint_velocity_rad_s;
  double base_pitch_rad = 0.0;
  double base_pitch_rate_rad_s = 0.0;
};

}  // namespace stilt::control
