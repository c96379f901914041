#pragma once

#include <cstddef>
#include <cstdint>

namespace stilt::hal::bring_up {

/// A setting of a driver that bring-up found to be wrong, under the vendor's name, or the key of the
/// configuration that is missing. The number is on the wire: new ones go to the end.
enum class Setting : std::uint8_t {
  none,
  moteus_position_bounds,
  moteus_trajectory_limits,
  moteus_kp,
  moteus_ki,
  moteus_kd,
  odrive_encoder_rate,
  odrive_heartbeat_rate,
  odrive_torque_mode_limit,
  damiao_control_mode,
  damiao_position_range,
  damiao_velocity_range,
  damiao_torque_range,
  damiao_timeout,
  moteus_timeout_mode,
  moteus_bemf_feedforward,
  odrive_velocity_limit,
  odrive_torque_rate,
  damiao_reply_id,
  ak_control_mode,
  ak_v3_status_rate,
  ak_v3_position_frames,
  moteus_zero,
  odrive_watchdog_endpoints,
  accepted_watchdog,
  moteus_command_line,
  ak_reply_id_own,
  ak_reply_id_zero,
  odrive_firmware_version,
  odrive_hardware_version,
  odrive_other_endpoints,
};
inline constexpr auto kSettings = static_cast<std::size_t>(Setting::odrive_other_endpoints) + 1;

/// The vendor's name, and what it must be. Real-time safe.
[[nodiscard]] constexpr const char* name(Setting setting) noexcept {
  switch (setting) {
    case Setting::none:
      return "none";
    case Setting::moteus_position_bounds:
      return "servopos.position_min and servopos.position_max must be nan, or contain the joint's travel";
    case Setting::moteus_trajectory_limits:
      return "servo.default_velocity_limit must be nan";
    case Setting::moteus_kp:
      return "servo.pid_position.kp must be moteus_kp_Nm_rev of the configuration";
    case Setting::moteus_ki:
      return "servo.pid_position.ki must be 0";
    case Setting::moteus_kd:
      return "servo.pid_position.kd must be moteus_kd_Nms_rev of the configuration";
    case Setting::odrive_encoder_rate:
      return "axis0.config.can.encoder_msg_rate_ms must be 1";
    case Setting::odrive_heartbeat_rate:
      return "axis0.config.can.heartbeat_msg_rate_ms must be at most 10";
    case Setting::odrive_torque_mode_limit:
      return "axis0.controller.config.enable_torque_mode_vel_limit must be false";
    case Setting::damiao_control_mode:
      return "CTRL_MODE must be 1 (MIT)";
    case Setting::damiao_position_range:
      return "PMAX must be position_range_rad of the configuration";
    case Setting::damiao_velocity_range:
      return "VMAX must be velocity_range_rad_s of the configuration";
    case Setting::damiao_torque_range:
      return "TMAX must be torque_range_Nm and reply_torque_range_Nm of the configuration";
    case Setting::damiao_timeout:
      return "TIMEOUT does not keep what is written";
    case Setting::moteus_timeout_mode:
      return "servo.timeout_mode must be 12";
    case Setting::moteus_bemf_feedforward:
      return "servo.bemf_feedforward must be 0";
    case Setting::odrive_velocity_limit:
      return "axis0.controller.config.vel_limit must be above the joint's velocity limit, or inf";
    case Setting::odrive_torque_rate:
      return "axis0.config.can.torques_msg_rate_ms must be at most 5, and not 0";
    case Setting::damiao_reply_id:
      return "MST_ID must be reply_id of the configuration, and is 0 as from the vendor";
    case Setting::ak_control_mode:
      return "it is in servo mode, and must be in MIT mode (R-Link); one of version 3 has the protocol ak_v3";
    case Setting::ak_v3_status_rate:
      return "its CAN feedback rate must be ak_v3_status_rate_hz of the configuration";
    case Setting::ak_v3_position_frames:
      return "its position frames (0x2A) must be on, as ak_v3_position_frames of the configuration";
    case Setting::moteus_zero:
      return "its zero must be within 3.2767 revolutions of all of the joint's travel: `stiltd zero JOINT`";
    case Setting::odrive_watchdog_endpoints:
      return "odrive_watchdog_timeout_endpoint and odrive_enable_watchdog_endpoint must be the ids of "
             "axis0.config.watchdog_timeout and axis0.config.enable_watchdog in flat_endpoints.json of its "
             "firmware, or accept_missing_watchdog must be true";
    case Setting::accepted_watchdog:
      return "accept_missing_watchdog must be true, and the emergency stop must cut its supply";
    case Setting::moteus_command_line:
      return "its command line must answer `conf get` with a number alone: close tview, and cycle its power";
    case Setting::ak_reply_id_own:
      return "reply_id of the configuration must be its id, with which it answers";
    case Setting::ak_reply_id_zero:
      return "reply_id of the configuration must be 0, with which it answers";
    case Setting::odrive_firmware_version:
      return "odrive_firmware_version must be that of the driver, and all endpoints those of its "
             "flat_endpoints.json";
    case Setting::odrive_hardware_version:
      return "odrive_hardware_version must be that of the driver, and all endpoints those of its "
             "flat_endpoints.json";
    case Setting::odrive_other_endpoints:
      return "odrive_watchdog_timeout_endpoint and odrive_enable_watchdog_endpoint are other parameters: "
             "they must be the ids of axis0.config.watchdog_timeout and axis0.config.enable_watchdog in "
             "flat_endpoints.json of its firmware";
  }
  return "unknown";
}

/// A key of the configuration, of the driver's section. Real-time safe.
[[nodiscard]] constexpr bool is_key(Setting setting) noexcept {
  switch (setting) {
    case Setting::odrive_watchdog_endpoints:
    case Setting::accepted_watchdog:
    case Setting::odrive_firmware_version:
    case Setting::odrive_hardware_version:
    case Setting::odrive_other_endpoints:
      return true;
    default:
      return false;
  }
}

}  // namespace stilt::hal::bring_up
