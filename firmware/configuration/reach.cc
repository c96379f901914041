#include "firmware/configuration/reach.h"

#include <cmath>
#include <string_view>

#include "firmware/configuration/schema.h"
#include "firmware/control_loop/joint_names.h"
#include "hal/robot/robot_wiring.h"

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

/// Where every shutdown and many a fault take the joints.
void check_sitting_pose(const supervisor::SupervisorParameters& parameters,
                        const model::RobotConstants& robot, std::vector<std::string>& found) {
  const supervisor::Pose pose_rad = supervisor::sitting_pose_rad(parameters);
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

}  // namespace

std::vector<std::string> unreachable(const Configuration& configuration, const model::RobotConstants& robot) {
  const HardwareParameters& hardware = configuration.hardware;
  const hal::RobotWiring wiring = robot_wiring(hardware);
  std::vector<std::string> found;
  check_sitting_pose(configuration.supervisor, robot, found);
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
