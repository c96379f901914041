#include "firmware/configuration/hardware_consistency.h"

#include <cstddef>
#include <optional>
#include <string>

#include "firmware/configuration/driver_of.h"
#include "firmware/configuration/schema.h"
#include "hal/mit/mit_mode.h"

namespace stilt::configuration {
namespace {

struct JointKeys {
  std::string_view bus, id;
};
constexpr JointKeys kKeys[hal::kJoints] = {{"hip_L.bus", "hip_L.id"},
                                           {"knee_L.bus", "knee_L.id"},
                                           {"hip_R.bus", "hip_R.id"},
                                           {"knee_R.bus", "knee_R.id"}};

/// Largest identifier a driver can have.
int largest_id(DriverProtocol protocol) {
  if (protocol == DriverProtocol::moteus) return hal::moteus::kMoteusMaximumId;
  if (protocol == DriverProtocol::odrive) return hal::odrive::kOdriveMaximumNode - 1;  // the last is for all
  if (protocol == DriverProtocol::mit_damiao) return 15;  // four bits of the reply identify the driver
  return 255;                                             // a byte of the reply identifies the driver
}

void check_bus(std::string_view key, int bus, std::size_t buses, std::vector<Contradiction>& found) {
  if (bus < static_cast<int>(buses)) return;
  found.push_back({{key, "hardware.buses"},
                   std::string(key) + " = " + std::to_string(bus) + ", but hardware.buses names " +
                       std::to_string(buses) + (buses == 1 ? " bus" : " buses") +
                       ", numbered from 0; name one more, or give --bus once for each"});
}

/// Buses through an adapter at a serial port.
constexpr std::string_view kAtSerialPort = "fdcanusb:";

/// Such an adapter sends no frame without data bytes: no question to an ODrive, no SYNC.
void check_questions(const HardwareParameters& hardware, const std::vector<std::string>& names,
                     std::vector<Contradiction>& found) {
  const auto check = [&](std::string_view key, int bus, const std::string& what) {
    if (bus >= static_cast<int>(names.size()) ||
        !names[static_cast<std::size_t>(bus)].starts_with(kAtSerialPort))
      return;
    found.push_back({{key, "hardware.buses"},
                     std::string(key) + " = " + std::to_string(bus) +
                         ": an fdcanusb sends no frame without data, " + what +
                         "; take a CAN interface for that bus"});
  };
  for (std::size_t i = 0; i < hal::kJoints; ++i) {
    if (driver_of(hardware, i).protocol == DriverProtocol::odrive)
      check(kKeys[i].bus, hardware.joint[i].bus, "which is how an ODrive is asked");
  }
  if (hardware.torso_sensor.device == TorsoDevice::canopen_encoder)
    check("torso_sensor.bus", hardware.torso_sensor.bus, "and the SYNC of an encoder is one");
}

/// A network interface has at most 15 characters, no slash, no colon. The names of other buses have a prefix,
/// and of an adapter at a serial port the path behind it.
void check_bus_names(const std::vector<std::string>& names, std::vector<Contradiction>& found) {
  constexpr std::string_view kLoopback = "loopback:";
  const std::string kAdapter = std::string(kAtSerialPort) + "/";
  constexpr std::size_t kLongestInterface = 15;
  for (const std::string& name : names) {
    const bool loopback = name.starts_with(kLoopback) && name.size() > kLoopback.size();
    const bool interface =
        !name.empty() && name.size() <= kLongestInterface && name.find_first_of("/: \t") == std::string::npos;
    const bool adapter = name.starts_with(kAdapter) && name.size() > kAdapter.size();
    if (loopback || interface || adapter) continue;
    found.push_back(
        {{"hardware.buses"},
         "\"" + name +
             "\" is no bus; a CAN interface such as can0, fdcanusb:/dev/PORT, or loopback:NAME, is one"});
  }
}

void check_can_fd(std::string_view key, const DriverParameters& driver, std::vector<Contradiction>& found) {
  const bool can = driver.protocol == DriverProtocol::mit_damiao || driver.protocol == DriverProtocol::odrive;
  if (!driver.can_fd || can) return;
  const bool moteus = driver.protocol == DriverProtocol::moteus;
  found.push_back({{key},
                   std::string(key) + " = true, but " +
                       (moteus ? "a moteus exchanges CAN FD frames by itself" : "this driver has no CAN FD") +
                       "; set it to false"});
}

struct VersionKeys {
  std::string_view firmware, hardware;
};
constexpr VersionKeys kHipVersions = {"hip_driver.odrive_firmware_version",
                                      "hip_driver.odrive_hardware_version"};
constexpr VersionKeys kKneeVersions = {"knee_driver.odrive_firmware_version",
                                       "knee_driver.odrive_hardware_version"};

/// Numbers of endpoints are those of one firmware for one hardware.
void check_endpoints(const VersionKeys& keys, const DriverParameters& driver,
                     std::vector<Contradiction>& found) {
  const bool any =
      driver.odrive_watchdog_timeout_endpoint != 0 || driver.odrive_enable_watchdog_endpoint != 0 ||
      driver.odrive_torque_mode_limit_endpoint != 0 || driver.odrive_velocity_limit_endpoint != 0;
  if (driver.protocol != DriverProtocol::odrive || !any) return;
  const auto require = [&found](std::string_view key, const std::string& version, const char* source) {
    if (version != "none") return;
    found.push_back({{key},
                     std::string(key) + " = \"none\", but endpoints of the driver are given; set it to " +
                         source + " of the flat_endpoints.json that has them"});
  };
  require(keys.firmware, driver.odrive_firmware_version, "fw_version");
  require(keys.hardware, driver.odrive_hardware_version, "hw_version");
}

struct RangeKeys {
  std::string_view position, kp, kd, torque, reply_torque;
};
constexpr RangeKeys kHipRanges = {"hip_driver.position_range_rad", "hip_driver.kp_range_Nm_rad",
                                  "hip_driver.kd_range_Nms_rad", "hip_driver.torque_range_Nm",
                                  "hip_driver.reply_torque_range_Nm"};
constexpr RangeKeys kKneeRanges = {"knee_driver.position_range_rad", "knee_driver.kp_range_Nm_rad",
                                   "knee_driver.kd_range_Nms_rad", "knee_driver.torque_range_Nm",
                                   "knee_driver.reply_torque_range_Nm"};

/// The ends of both gains in the firmware of every such driver.
struct VendorGains {
  std::string_view drivers;
  double kp_Nm_rad = 0;
  double kd_Nms_rad = 0;
};

/// Nothing where they are the user's choice: in the firmware of a mini-cheetah, or in the driver.
std::optional<VendorGains> vendor_gains(DriverProtocol protocol) {
  using hal::mit::kVendorKd_Nms_rad, hal::mit::kVendorKp_Nm_rad;
  switch (protocol) {
    case DriverProtocol::mit_damiao:
      return VendorGains{"every Damiao", kVendorKp_Nm_rad, kVendorKd_Nms_rad};
    case DriverProtocol::mit_ak:
      return VendorGains{"every AK of version 1 or 2", kVendorKp_Nm_rad, kVendorKd_Nms_rad};
    case DriverProtocol::ak_v3:
      return VendorGains{"every AK of version 3", hal::ak::kAkKp_Nm_rad, hal::ak::kAkKd_Nms_rad};
    case DriverProtocol::mit_mini_cheetah:
    case DriverProtocol::moteus:
    case DriverProtocol::odrive:
      return std::nullopt;
  }
  return std::nullopt;
}

/// Another range than that of the firmware scales every command wrongly. Those of velocity and torque are of
/// the model, and of an AK of version 3 those alone.
void check_vendor_ranges(const RangeKeys& keys, const DriverParameters& driver,
                         std::vector<Contradiction>& found) {
  const std::optional<VendorGains> vendor = vendor_gains(driver.protocol);
  if (!vendor) return;
  constexpr double kLeastPosition_rad = 12.5, kMostPosition_rad = 12.57;  // documents of its vendors differ
  const auto refuse = [&](std::string_view key, double is, double right) {
    found.push_back({{key},
                     std::string(key) + " = " + number_text(is) + ", but that of " +
                         std::string(vendor->drivers) + " is " + number_text(right) + "; set it to that"});
  };
  if (driver.protocol == DriverProtocol::ak_v3 &&
      (driver.position_range_rad < kLeastPosition_rad || driver.position_range_rad > kMostPosition_rad)) {
    refuse(keys.position, driver.position_range_rad, hal::ak::kAkPosition_rad);
  }
  if (driver.kp_range_Nm_rad != vendor->kp_Nm_rad) refuse(keys.kp, driver.kp_range_Nm_rad, vendor->kp_Nm_rad);
  if (driver.kd_range_Nms_rad != vendor->kd_Nms_rad)
    refuse(keys.kd, driver.kd_range_Nms_rad, vendor->kd_Nms_rad);
}

/// Commands and replies of a Damiao or an AK have one range of torque.
void check_torque_ranges(const RangeKeys& keys, const DriverParameters& driver,
                         std::vector<Contradiction>& found) {
  const bool damiao = driver.protocol == DriverProtocol::mit_damiao;
  if (!damiao && driver.protocol != DriverProtocol::mit_ak) return;
  if (driver.reply_torque_range_Nm == driver.torque_range_Nm) return;
  found.push_back({{keys.reply_torque, keys.torque},
                   std::string(keys.reply_torque) + " = " + number_text(driver.reply_torque_range_Nm) +
                       " must be " + std::string(keys.torque) + " = " + number_text(driver.torque_range_Nm) +
                       (damiao ? ": a Damiao has one range for both, its TMAX"
                               : ": an AK of version 1 or 2 has one range for both, that of its model")});
}

void check_ids(const HardwareParameters& hardware, std::size_t i, std::vector<Contradiction>& found) {
  const JointParameters& joint = hardware.joint[i];
  const DriverProtocol protocol = driver_of(hardware, i).protocol;
  const int least = protocol == DriverProtocol::moteus ? 1 : 0;
  if (joint.id < least || joint.id > largest_id(protocol)) {
    found.push_back({{kKeys[i].id},
                     std::string(kKeys[i].id) + " = " + std::to_string(joint.id) +
                         ": identifiers of this driver are " + std::to_string(least) + " to " +
                         std::to_string(largest_id(protocol))});
  }
}

/// Longer, and sitting has moved far before its gains hold the robot.
void check_hold_ramp(const supervisor::SupervisorParameters& supervisor, std::vector<Contradiction>& found) {
  constexpr double kMostShare = 0.25;
  const double most_s = kMostShare * supervisor.sit_s;
  if (supervisor.hold_ramp_s <= most_s) return;
  found.push_back({{"supervisor.hold_ramp_s", "supervisor.sit_s"},
                   "supervisor.hold_ramp_s = " + number_text(supervisor.hold_ramp_s) +
                       " must be at most a quarter of supervisor.sit_s, " + number_text(most_s) +
                       ": the robot would fall before the gains of sitting are there"});
}

}  // namespace

void check_hardware(const HardwareParameters& hardware, std::vector<Contradiction>& found) {
  const std::vector<std::string> names = bus_names(hardware);
  const std::size_t buses = names.size();
  const std::size_t before = found.size();
  check_bus_names(names, found);
  check_can_fd("hip_driver.can_fd", hardware.hip, found);
  check_can_fd("knee_driver.can_fd", hardware.knee, found);
  check_endpoints(kHipVersions, hardware.hip, found);
  check_endpoints(kKneeVersions, hardware.knee, found);
  check_vendor_ranges(kHipRanges, hardware.hip, found);
  check_vendor_ranges(kKneeRanges, hardware.knee, found);
  check_torque_ranges(kHipRanges, hardware.hip, found);
  check_torque_ranges(kKneeRanges, hardware.knee, found);
  for (std::size_t i = 0; i < hal::kJoints; ++i) {
    check_bus(kKeys[i].bus, hardware.joint[i].bus, buses, found);
    check_ids(hardware, i, found);
  }
  check_bus("torso_sensor.bus", hardware.torso_sensor.bus, buses, found);
  check_questions(hardware, names, found);
  check_torso_sensor(hardware, found);
  if (found.size() == before) check_identifiers(hardware, found);
  if (found.size() == before && !hal::valid(robot_wiring(hardware), buses)) {
    found.push_back({{"hardware.buses"}, "the wiring of the joints contradicts itself"});
  }
}

void check_supply(const HardwareParameters& hardware, const supervisor::SupervisorParameters& supervisor,
                  std::vector<Contradiction>& found) {
  constexpr double kMost_V = hal::mit::MitDriver{}.supply_V.maximum;
  for (const auto& [key, driver] :
       {std::pair{"hip_driver.protocol", &hardware.hip}, std::pair{"knee_driver.protocol", &hardware.knee}}) {
    if (driver->protocol != DriverProtocol::mit_mini_cheetah || supervisor.low_voltage_V < kMost_V) continue;
    found.push_back({{"supervisor.low_voltage_V", key},
                     "supervisor.low_voltage_V = " + number_text(supervisor.low_voltage_V) +
                         " must be below " + number_text(kMost_V) +
                         " V, the most that a mini-cheetah reports (" + key + ")"});
  }
}

void check_supervisor(const supervisor::SupervisorParameters& supervisor, std::vector<Contradiction>& found) {
  const auto check = [&found](std::string_view mild_key, double mild, std::string_view hard_key,
                              double hard) {
    if (mild < hard) return;
    found.push_back({{mild_key, hard_key},
                     std::string(mild_key) + " = " + number_text(mild) + " must be below " +
                         std::string(hard_key) + " = " + number_text(hard)});
  };
  check("supervisor.missed_hold_ticks", supervisor.missed_hold_ticks, "supervisor.missed_damp_ticks",
        supervisor.missed_damp_ticks);
  check("supervisor.hot_C", supervisor.hot_C, "supervisor.overheated_C", supervisor.overheated_C);
  check("supervisor.low_voltage_V", supervisor.low_voltage_V, "supervisor.high_voltage_V",
        supervisor.high_voltage_V);
  check("supervisor.plan_feedback_after_s", supervisor.plan_feedback_after_s, "supervisor.stale_plan_s",
        supervisor.stale_plan_s);
  check("supervisor.torque_loop_overrun_s", supervisor.torque_loop_overrun_s,
        "supervisor.torque_loop_stall_s", supervisor.torque_loop_stall_s);
  check("supervisor.stale_plan_s", supervisor.stale_plan_s, "supervisor.planner_lost_s",
        supervisor.planner_lost_s);
  check("supervisor.heartbeat_timeout_s", supervisor.heartbeat_timeout_s, "supervisor.operator_gone_s",
        supervisor.operator_gone_s);
  check("supervisor.stand_pose_margin_rad", supervisor.stand_pose_margin_rad, "supervisor.stance_margin_rad",
        supervisor.stance_margin_rad);
  check_hold_ramp(supervisor, found);
  if (!supervisor.select_gait || supervisor.track_gait) return;
  found.push_back({{"supervisor.select_gait", "supervisor.track_gait"},
                   "supervisor.select_gait = true needs supervisor.track_gait = true: no gait is tracked "
                   "otherwise"});
}

void check_runtime(const RuntimeParameters& runtime, std::vector<Contradiction>& found) {
  const bool ordinary = runtime.planner_priority == 0 && runtime.torque_priority == 0;
  if (ordinary || runtime.planner_priority <= runtime.torque_priority - 2) return;
  found.push_back(
      {{"runtime.planner_priority", "runtime.torque_priority"},
       "runtime.planner_priority = " + std::to_string(runtime.planner_priority) +
           " must be at least 2 below runtime.torque_priority = " + std::to_string(runtime.torque_priority) +
           ": the threads of adapters and torso sensors at serial ports have the one between"});
}

}  // namespace stilt::configuration
