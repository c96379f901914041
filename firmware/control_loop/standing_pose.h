#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "mpc_core/control/estimator.h"
#include "mpc_core/gait/reference.h"

namespace stilt::control_loop {

/// What of the robot is not as a pose requires, and between which values it would be.
struct PoseMiss {
  static constexpr int kTorso = static_cast<int>(model::kJoints);
  int joint = -1;  ///< hip_L, knee_L, hip_R, knee_R from 0; kTorso; -1: nothing, it is in the pose
  double value = 0.0;
  double lowest = 0.0;
  double highest = 0.0;
  const char* unit = "rad";  ///< of all three
  [[nodiscard]] bool none() const noexcept { return joint < 0; }
};

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

  /// The joint farthest from the nearer one of both poses, or the torso, beyond the margin. What is not
  /// finite is beyond it.
  [[nodiscard]] PoseMiss miss(const control::SensorReading& reading, double margin_rad) const noexcept {
    const PoseMiss left = miss_of(joints_rad_[0], reading, margin_rad);
    const PoseMiss right = miss_of(joints_rad_[1], reading, margin_rad);
    const PoseMiss& joints = off(right) < off(left) ? right : left;
    if (!joints.none()) return joints;
    const double pitch_rad = reading.base_pitch_rad;
    if (std::abs(pitch_rad - pitch_rad_) <= margin_rad) return {};
    return {PoseMiss::kTorso, pitch_rad, pitch_rad_ - margin_rad, pitch_rad_ + margin_rad};
  }

 private:
  /// How far a value is from the middle of its range; infinite for what is not finite.
  static double off(const PoseMiss& miss) noexcept {
    const double distance = std::abs(miss.value - 0.5 * (miss.lowest + miss.highest));
    return std::isfinite(distance) ? distance : std::numeric_limits<double>::infinity();
  }

  static PoseMiss miss_of(const model::JointVector& pose_rad, const control::SensorReading& reading,
                          double margin_rad) noexcept {
    PoseMiss farthest;
    for (int joint = 0; joint < model::kJoints; ++joint) {
      const double angle_rad = reading.joint_position_rad[joint];
      if (std::abs(angle_rad - pose_rad[joint]) <= margin_rad) continue;
      const PoseMiss miss{joint, angle_rad, pose_rad[joint] - margin_rad, pose_rad[joint] + margin_rad};
      if (farthest.none() || off(miss) > off(farthest)) farthest = miss;
    }
    return farthest;
  }

  std::array<model::JointVector, 2> joints_rad_;
  double pitch_rad_ = 0.0;
};

/// The first joint, or the torso, that is faster than the limit. What is not finite is faster.
[[nodiscard]] inline PoseMiss too_fast(const control::SensorReading& reading, double speed_rad_s) noexcept {
  for (int joint = 0; joint <= PoseMiss::kTorso; ++joint) {
    const double rate_rad_s =
        joint < PoseMiss::kTorso ? reading.joint_velocity_rad_s[joint] : reading.base_pitch_rate_rad_s;
    if (!(std::abs(rate_rad_s) <= speed_rad_s)) {
      return {joint, rate_rad_s, -speed_rad_s, speed_rad_s, "rad/s"};
    }
  }
  return {};
}

}  // namespace stilt::control_loop
