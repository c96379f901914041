#pragma once

#include <array>
#include <cmath>

#include "mpc_core/control/estimator.h"
#include "mpc_core/gait/reference.h"

namespace stilt::control_loop {

/// Standing still with one foot ahead, either one. Real-time safe.
class StandingPose {
 public:
  StandingPose() = default;
  StandingPose(const model::RobotModel& robot, const control::ControllerParameters& parameters) noexcept
      : pitch_rad_(parameters.reference.base_pitch_rad) {
    for (const bool left_ahead : {true, false}) {
      joints_rad_[left_ahead ? 0 : 1] =
          gait::standing_state(robot.constants, parameters.reference.base_height_m, pitch_rad_,
                               parameters.gait.stand_half_width_m, left_ahead)
              .segment<model::kJoints>(model::kFirstJoint);
    }
  }

  /// Every joint and the torso within the margin of it. False for anything that is not finite.
  [[nodiscard]] bool near(const control::SensorReading& reading, double margin_rad) const noexcept {
    const auto within = [&](const model::JointVector& standing_rad) {
      return (reading.joint_position_rad - standing_rad).cwiseAbs().maxCoeff() <= margin_rad;
    };
    return reading.joint_position_rad.allFinite() && (within(joints_rad_[0]) || within(joints_rad_[1])) &&
           std::abs(reading.base_pitch_rad - pitch_rad_) <= margin_rad;
  }

 private:
  std::array<model::JointVector, 2> joints_rad_;
  double pitch_rad_ = 0.0;
};

/// No joint and not the torso faster than the limit. False for anything that is not finite.
[[nodiscard]] inline bool slower_than(const control::SensorReading& reading, double speed_rad_s) noexcept {
  return reading.joint_velocity_rad_s.allFinite() && std::abs(reading.base_pitch_rate_rad_s) <= speed_rad_s &&
         reading.joint_velocity_rad_s.cwiseAbs().maxCoeff() <= speed_rad_s;
}

}  // namespace stilt::control_loop
