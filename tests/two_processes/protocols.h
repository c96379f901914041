#pragma once

#include <string>
#include <vector>

namespace stilt::two_processes {

/// All protocols of drivers, as configuration names them.
inline constexpr const char* kProtocols[] = {"mit_damiao", "mit_ak", "mit_mini_cheetah",
                                             "moteus",     "odrive", "ak_v3"};

/// Options of robot and controller that give every joint this protocol; the torso sensor moves away from the
/// identifiers of ODrives.
[[nodiscard]] inline std::vector<std::string> with_protocol(const std::string& protocol) {
  const std::string frame = "id 0x700 byte ";
  std::vector<std::string> settings = {
      "torso_sensor.pitch=" + frame + "0 bits 32 signed little scale 1e-8",
      "torso_sensor.pitch_rate=" + frame + "4 bits 24 signed little scale 2e-6",
      "torso_sensor.emergency_stop_released=" + frame + "7 bits 1 unsigned little scale 1"};
  for (const std::string driver : {"hip_driver.", "knee_driver."}) {
    settings.push_back(std::string(driver).append("protocol=").append(protocol));
    settings.push_back(driver + "moteus_kp_Nm_rev=2000");
    settings.push_back(driver + "moteus_kd_Nms_rev=100");
    settings.push_back(driver + "odrive_watchdog_timeout_endpoint=17");
    settings.push_back(driver + "odrive_enable_watchdog_endpoint=18");
    settings.push_back(driver + "odrive_firmware_version=0.6.11");
    settings.push_back(driver + "odrive_hardware_version=4.4.58");
    settings.push_back(driver + "accept_missing_watchdog=true");
    if (protocol != "ak_v3") continue;
    settings.push_back(driver + "position_range_rad=12.56");
    settings.push_back(driver + "ak_v3_torque_constant_Nm_A=2");
  }
  std::vector<std::string> options;
  for (const std::string& setting : settings) options.insert(options.end(), {"--set", setting});
  return options;
}

}  // namespace stilt::two_processes
