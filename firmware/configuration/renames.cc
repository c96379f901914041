#include "firmware/configuration/renames.h"

#include <algorithm>
#include <iterator>

namespace stilt::configuration {
namespace {

constexpr Rename kRenames[] = {
    {"inequality", "friction_mu", "friction_barrier_weight"},
    {"inequality", "friction_delta", "friction_barrier_width_N"},
    {"inequality", "joint_torque_mu", "joint_torque_barrier_weight"},
    {"inequality", "joint_torque_delta", "joint_torque_barrier_width_Nm"},
    {"inequality", "joint_position_mu", "joint_position_barrier_weight"},
    {"inequality", "joint_position_delta", "joint_position_barrier_width_rad"},
    {"inequality", "joint_velocity_mu", "joint_velocity_barrier_weight"},
    {"inequality", "joint_velocity_delta", "joint_velocity_barrier_width_rad_s"},
    {"inequality", "minimum_normal_force_N", "minimum_normal_force_share",
     "divide its newtons by the weight of the robot"},
    {"sqp", "g_max", "filter_violation_max"},
    {"sqp", "g_min", "filter_violation_min"},
    {"sqp", "gamma_c", "filter_margin"},
    {"sqp", "plan_force_violation_max_N", "plan_cone_violation_max_N"},
    {"supervisor", "older_plan_s", "plan_feedback_after_s"},
    {"supervisor", "frozen_ticks", "unchanged_replies_limit"},
    {"supervisor", "base_angle_limit_rad", "base_pitch_limit_rad"},
    {"supervisor", "emergency_stop_damps_s", "damped_before_off_s"},
    {"base_sensor", "", "torso_sensor"},
};

}  // namespace

std::span<const Rename> renames() { return kRenames; }

const Rename* find_rename(std::string_view section, std::string_view key) {
  const Rename* found = std::ranges::find_if(
      kRenames, [&](const Rename& rename) { return rename.section == section && rename.key == key; });
  return found == std::end(kRenames) ? nullptr : found;
}

std::string to_string(const Rename& rename) {
  const std::string_view old = rename.key.empty() ? rename.section : rename.key;
  std::string text = std::string(old) + " is now " + std::string(rename.now);
  if (!rename.value_change.empty()) text += ", in another unit: " + std::string(rename.value_change);
  return text;
}

}  // namespace stilt::configuration
