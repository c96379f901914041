#include "firmware/configuration/reach.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "firmware/configuration/schema.h"
#include "firmware/control_loop/joint_names.h"
#include "hal/robot/robot_wiring.h"
#include "mpc_core/gait/reference.h"
#include "mpc_core/model/leg_exchange.h"

namespace stilt::configuration {
namespace {

/// One thing a joint does, at the driver's shaft, and what its frames carry.
struct Need {
  std::string_view what;
  double wanted = 0;
  double carried = 0;
  std::string_view unit;
};

std::string sentence(std::size_t joint, const Need& need) {
  return std::string(control_loop::kJointNames[joint]) + ": " + std::string(need.what) + " of up to " +
         number_text(need.wanted) + ' ' + std::string(need.unit) +
         " at the shaft, and the frames of its driver carry at most " + number_text(need.carried) + ' ' +
         std::string(need.unit) + "; see " + control_loop::driver_section(joint) +
         ".ratio, the joint's offset_rad and torque_factor, and the driver's ranges";
}

std::string rounded_text(double value) { return number_text(std::round(1e4 * value) / 1e4); }

/// Where the robot stands up, either foot ahead. Beyond their reach gait::leg_angles() takes the legs as
/// straight.
void check_standing_pose(const control::ControllerParameters& parameters, const model::RobotConstants& robot,
                         std::vector<std::string>& found) {
  constexpr const char* kRight = "; give a pose in which this robot stands";
  const double height_m = parameters.reference.base_height_m;
  const double half_width_m = parameters.gait.stand_half_width_m;
  const std::string stance = "reference.base_height_m = " + number_text(height_m) +
                             " and gait.stand_half_width_m = " + number_text(half_width_m);
  const double foot_m = std::hypot(half_width_m, height_m);
  const double least_m = std::abs(robot.thigh_length_m - robot.shin_length_m);
  const double most_m = robot.thigh_length_m + robot.shin_length_m;
  if (foot_m <= least_m || foot_m >= most_m) {
    found.push_back(stance + " put the feet " + rounded_text(foot_m) + " m from the hip, and legs of " +
                    number_text(robot.thigh_length_m) + " m and " + number_text(robot.shin_length_m) +
                    " m reach from " + rounded_text(least_m) + " to " + rounded_text(most_m) + " m" + kRight);
    return;
  }
  const model::StateVector standing =
      gait::standing_state(robot, height_m, parameters.reference.base_pitch_rad, half_width_m, true);
  for (int joint = 0; joint < model::kJoints; ++joint) {
    const double least_rad = robot.position_min_rad[joint], most_rad = robot.position_max_rad[joint];
    for (const int ahead_or_behind : {joint, model::other_leg(joint, 0)}) {
      const double angle_rad = standing[model::kFirstJoint + ahead_or_behind];
      if (angle_rad >= least_rad && angle_rad <= most_rad) continue;
      found.push_back(std::string(control_loop::kJointNames[joint]) + ": " + stance + " take it to " +
                      rounded_text(angle_rad) + " rad, beyond its travel, " + number_text(least_rad) +
                      " to " + number_text(most_rad) + " rad" + kRight);
    }
  }
}

/// Limits of the supervisor that the standing pose is beyond would damp the robot as soon as it stands.
void check_limits_of_stand(const Configuration& configuration, const model::RobotConstants& robot,
                           std::vector<std::string>& found) {
  constexpr double kShareMargin = 0.05;  // the hip goes down under a push, and up and down in a walk
  constexpr double kPitchMargin_rad = 0.1;
  const double share = configuration.reference.base_height_m / (robot.thigh_length_m + robot.shin_length_m);
  const double least_share = configuration.supervisor.hip_height_share;
  if (least_share > share - kShareMargin) {
    found.push_back("supervisor.hip_height_share = " + number_text(least_share) +
                    " must be at least 0.05 below the share of the leg at which the robot stands, " +
                    rounded_text(share) + " (reference.base_height_m)");
  }
  const double pitch_rad = std::abs(configuration.reference.base_pitch_rad);
  const double most_rad = configuration.supervisor.base_pitch_limit_rad;
  if (most_rad < pitch_rad + kPitchMargin_rad) {
    found.push_back("supervisor.base_pitch_limit_rad = " + number_text(most_rad) +
                    " must be at least 0.1 rad above reference.base_pitch_rad either way, " +
                    number_text(pitch_rad));
  }
}

/// Where every shutdown and many a fault take the joints.
void check_sitting_pose(const supervisor::SupervisorParameters& parameters,
                        const model::RobotConstants& robot, std::vector<std::string>& found) {
  const hal::JointValues pose_rad = supervisor::sitting_pose_rad(parameters);
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    const double least_rad = robot.position_min_rad[joint], most_rad = robot.position_max_rad[joint];
    if (pose_rad[joint] >= least_rad && pose_rad[joint] <= most_rad) continue;
    const std::string key = joint % 2 == 0 ? "supervisor.sit_hip_rad" : "supervisor.sit_knee_rad";
    found.push_back(std::string(control_loop::kJointNames[joint]) + ": " + key + " = " +
                    number_text(pose_rad[joint]) + " is beyond the joint's travel, " +
                    number_text(least_rad) + " to " + number_text(most_rad) +
                    " rad; give a pose in which this robot sits");
  }
}

/// On feet far ahead of the hip, far behind or level with it the robot falls over. A pose above that of the
/// stand lifts it first, and it falls from there once damped. The torso counts as upright.
void check_feet_of_sitting_pose(const Configuration& configuration, const model::RobotConstants& robot,
                                std::vector<std::string>& found) {
  constexpr double kMostShare = 0.25;  // of the straight leg
  const supervisor::SupervisorParameters& supervisor = configuration.supervisor;
  const double thigh_rad = supervisor.sit_hip_rad, shin_rad = thigh_rad + supervisor.sit_knee_rad;
  const double thigh_m = robot.thigh_length_m, shin_m = robot.shin_length_m;
  const double ahead_m = -thigh_m * std::sin(thigh_rad) - shin_m * std::sin(shin_rad);
  const double below_m = thigh_m * std::cos(thigh_rad) + shin_m * std::cos(shin_rad);
  const double most_m = kMostShare * (thigh_m + shin_m);
  const double height_m = configuration.reference.base_height_m;
  if (std::abs(ahead_m) <= most_m && below_m > 0 && below_m < height_m) return;
  found.push_back(
      "supervisor.sit_hip_rad = " + number_text(supervisor.sit_hip_rad) + " and supervisor.sit_knee_rad = " +
      number_text(supervisor.sit_knee_rad) + " put the feet " + rounded_text(std::abs(ahead_m)) + " m " +
      (ahead_m < 0 ? "behind" : "ahead of") + " the hip and " + rounded_text(std::abs(below_m)) + " m " +
      (below_m < 0 ? "above" : "below") + " it; this robot sits on feet at most " + rounded_text(most_m) +
      " m ahead or behind, below the hip by less than reference.base_height_m = " + number_text(height_m));
}

/// The way from the stand to the sitting pose, either foot ahead. Its largest speed is 1.5 times the mean
/// (supervisor::pose_between_rad).
void check_speed_of_sitting(const Configuration& configuration, const model::RobotConstants& robot,
                            std::vector<std::string>& found) {
  constexpr double kPeakOfMean = 1.5;
  constexpr double kMostShare = 0.5;  // of the speed limit; the weight of the robot adds to the speed
  const double sit_s = configuration.supervisor.sit_s;
  const hal::JointValues pose_rad = supervisor::sitting_pose_rad(configuration.supervisor);
  const model::StateVector standing = gait::standing_state(robot, configuration.reference.base_height_m,
                                                           configuration.reference.base_pitch_rad,
                                                           configuration.gait.stand_half_width_m, true);
  for (int joint = 0; joint < model::kJoints; ++joint) {
    double travel_rad = 0;
    for (const int ahead_or_behind : {joint, model::other_leg(joint, 0)}) {
      const double from_rad = standing[model::kFirstJoint + ahead_or_behind];
      travel_rad = std::max(travel_rad, std::abs(pose_rad[static_cast<std::size_t>(joint)] - from_rad));
    }
    const double most_rad_s = kMostShare * robot.velocity_limit_rad_s[joint];
    const double least_s = kPeakOfMean * travel_rad / most_rad_s;
    if (sit_s >= least_s) continue;
    found.push_back(std::string(control_loop::kJointNames[joint]) + ": supervisor.sit_s = " +
                    number_text(sit_s) + " takes it from the stand to the sitting pose at up to " +
                    rounded_text(kPeakOfMean * travel_rad / sit_s) + " rad/s, beyond " +
                    number_text(most_rad_s) + " rad/s, half of its speed limit; sit down in at least " +
                    number_text(std::ceil(1e3 * least_s) / 1e3) + " s");
  }
}

}  // namespace

std::vector<std::string> unreachable_poses(const Configuration& configuration,
                                           const model::RobotConstants& robot) {
  std::vector<std::string> found;
  check_standing_pose(configuration, robot, found);
  check_limits_of_stand(configuration, robot, found);
  check_sitting_pose(configuration.supervisor, robot, found);
  check_feet_of_sitting_pose(configuration, robot, found);
  check_speed_of_sitting(configuration, robot, found);
  return found;
}

std::vector<std::string> unreachable(const Configuration& configuration, const model::RobotConstants& robot) {
  const HardwareParameters& hardware = configuration.hardware;
  const hal::RobotWiring wiring = robot_wiring(hardware);
  std::vector<std::string> found = unreachable_poses(configuration, robot);
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    const std::optional<hal::FrameReach> reach = hal::visit_driver(
        wiring.joints[joint].driver, [](const auto& driver) { return frame_reach(driver); });
    if (!reach) continue;
    const auto farthest_rad = [&](double margin_rad) {
      const hal::bring_up::Options travel =
          bring_up_options(hardware, joint, robot.position_min_rad[joint] - margin_rad,
                           robot.position_max_rad[joint] + margin_rad);
      return std::max(std::abs(travel.minimum_angle_rad), std::abs(travel.maximum_angle_rad));
    };
    const double ratio = wiring.joints[joint].ratio;
    const double speed_rad_s = robot.velocity_limit_rad_s[joint];
    const supervisor::SupervisorParameters& supervisor = configuration.supervisor;
    const Need needs[] = {
        {"commands an angle", farthest_rad(kTravelMargin_rad), reach->command_position_rad, "rad"},
        {"commands a torque",
         supervisor.torque_limit_share * robot.torque_limit_Nm[joint] /
             (ratio * wiring.joints[joint].torque_factor),
         reach->command_torque_Nm, "Nm"},
        {"reads an angle", farthest_rad(supervisor.position_margin_rad), reach->reply_position_rad, "rad"},
        {"commands a velocity", ratio * speed_rad_s, reach->command_velocity_rad_s, "rad/s"},
        {"reads a velocity", ratio * (speed_rad_s + supervisor.speed_margin_rad_s),
         reach->reply_velocity_rad_s, "rad/s"},
    };
    for (const Need& need : needs) {
      if (need.wanted > need.carried) found.push_back(sentence(joint, need));
    }
  }
  return found;
}

}  // namespace stilt::configuration
