#include "firmware/configuration/hardware.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "firmware/configuration/channel_text.h"
#include "firmware/configuration/driver_of.h"
#include "firmware/configuration/version_text.h"
#include "hal/robot/wiring_load.h"

namespace stilt::configuration {
namespace {

using hal::BaseChannel;

hal::mit::ReplyLayout layout_of(DriverProtocol protocol) {
  if (protocol == DriverProtocol::mit_ak) return hal::mit::ReplyLayout::ak;
  if (protocol == DriverProtocol::mit_damiao) return hal::mit::ReplyLayout::damiao;
  return hal::mit::ReplyLayout::mini_cheetah;
}

hal::mit::Range around_zero(double maximum) { return {-maximum, maximum}; }

hal::mit::MitDriver mit_driver(const DriverParameters& driver, const JointParameters& joint) {
  hal::mit::MitDriver mit;
  mit.command_id = static_cast<std::uint16_t>(joint.id);
  mit.reply_id = static_cast<std::uint16_t>(joint.reply_id);
  mit.driver_id = static_cast<std::uint8_t>(joint.id);
  mit.layout = layout_of(driver.protocol);
  mit.position_rad = mit.reply_position_rad = around_zero(driver.position_range_rad);
  mit.velocity_rad_s = mit.reply_velocity_rad_s = around_zero(driver.velocity_range_rad_s);
  mit.kp_Nm_rad = {0, driver.kp_range_Nm_rad};
  mit.kd_Nms_rad = {0, driver.kd_range_Nms_rad};
  mit.torque_Nm = around_zero(driver.torque_range_Nm);
  mit.reply_torque_Nm = around_zero(driver.reply_torque_range_Nm);
  mit.temperature_offset_C = driver.ak_temperature_offset_C;
  return mit;
}

hal::moteus::MoteusDriver moteus_driver(const HardwareParameters& hardware, std::size_t joint) {
  const DriverParameters& driver = driver_of(hardware, joint);
  const TorsoSensorParameters& sensor = hardware.torso_sensor;
  hal::moteus::MoteusDriver moteus;
  moteus.id = static_cast<std::uint8_t>(hardware.joint[joint].id);
  moteus.bit_rate_switch = driver.bit_rate_switch;
  moteus.kp_Nm_rev = driver.moteus_kp_Nm_rev;
  moteus.kd_Nm_s_rev = driver.moteus_kd_Nms_rev;
  moteus.extra_encoder = sensor.encoder_joint == static_cast<int>(joint) ? sensor.encoder_number : -1;
  return moteus;
}

hal::odrive::OdriveDriver odrive_driver(const DriverParameters& driver, const JointParameters& joint) {
  return {
      .node = static_cast<std::uint8_t>(joint.id),
      .endpoints = {.watchdog_timeout = static_cast<std::uint16_t>(driver.odrive_watchdog_timeout_endpoint),
                    .enable_watchdog = static_cast<std::uint16_t>(driver.odrive_enable_watchdog_endpoint),
                    .torque_mode_limit = static_cast<std::uint16_t>(driver.odrive_torque_mode_limit_endpoint),
                    .velocity_limit = static_cast<std::uint16_t>(driver.odrive_velocity_limit_endpoint),
                    .firmware_version = parse_version(driver.odrive_firmware_version).value_or(0),
                    .hardware_version = parse_version(driver.odrive_hardware_version).value_or(0)}};
}

hal::ak::AkDriver ak_driver(const DriverParameters& driver, const JointParameters& joint) {
  return {.id = static_cast<std::uint8_t>(joint.id),
          .position_rad = driver.position_range_rad,
          .velocity_rad_s = driver.velocity_range_rad_s,
          .kp_Nm_rad = driver.kp_range_Nm_rad,
          .kd_Nms_rad = driver.kd_range_Nms_rad,
          .torque_Nm = driver.torque_range_Nm,
          .status_rate_hz = driver.ak_v3_status_rate_hz,
          .position_frames = driver.ak_v3_position_frames,
          .pole_pairs = driver.ak_v3_pole_pairs,
          .gear_ratio = driver.ak_v3_gear_ratio,
          .torque_constant_Nm_A = driver.ak_v3_torque_constant_Nm_A};
}

hal::JointWiring joint_wiring(const HardwareParameters& hardware, std::size_t joint) {
  const DriverParameters& driver = driver_of(hardware, joint);
  const JointParameters& place = hardware.joint[joint];
  hal::JointWiring wiring;
  wiring.bus = static_cast<std::uint8_t>(place.bus);
  wiring.direction = place.reversed ? -1 : 1;
  wiring.ratio = driver.ratio;
  wiring.offset_rad = place.offset_rad;
  wiring.torque_factor = place.torque_factor;
  wiring.can_fd = driver.can_fd;
  wiring.bit_rate_switch = driver.bit_rate_switch;
  if (driver.protocol == DriverProtocol::moteus) {
    wiring.driver = moteus_driver(hardware, joint);
  } else if (driver.protocol == DriverProtocol::odrive) {
    wiring.driver = odrive_driver(driver, place);
  } else if (driver.protocol == DriverProtocol::ak_v3) {
    wiring.driver = ak_driver(driver, place);
  } else {
    wiring.driver = mit_driver(driver, place);
  }
  return wiring;
}

void add_channel(const std::string& text, BaseChannel channel, hal::RobotWiring& wiring) {
  const auto row = parse_channel(text, channel);
  if (row && *row) wiring.channels[wiring.channel_count++] = **row;
}

/// Euler angles (0x022: roll, pitch, yaw) and rates of turn (0x032: x, y, z) of an Xsens MTi, 16 bits each,
/// most significant byte first. y is to the left, as in the torso's frame. A roll repeats after a turn, a
/// pitch ends at a quarter of one. Source: Movella, "MTi CAN messages", mtidocs.movella.com/canmessages; MT
/// CAN protocol, MT1604P.
void add_xsens(const TorsoSensorParameters& sensor, hal::RobotWiring& wiring) {
  constexpr double kAngleStep_rad = std::numbers::pi / 180 / 128;
  constexpr double kRateStep_rad_s = 1.0 / 512;
  const double direction = sensor.imu_reversed ? -1 : 1;
  const bool by_roll = sensor.imu_axis == ImuAxis::roll;
  const std::uint8_t byte = by_roll ? 0 : 2;
  if (by_roll) wiring.channel_pitch_period_rad = 2 * std::numbers::pi;
  hal::ChannelRow row{.id = 0x022, .byte_offset = byte, .bits = 16, .order = hal::ByteOrder::big};
  row.scale = direction * kAngleStep_rad;
  row.offset = sensor.imu_offset_rad;
  row.channel = BaseChannel::pitch_rad;
  wiring.channels[wiring.channel_count++] = row;
  row.id = 0x032;
  row.scale = direction * kRateStep_rad_s;
  row.offset = 0;
  row.channel = BaseChannel::pitch_rate_rad_s;
  wiring.channels[wiring.channel_count++] = row;
}

void add_pitch(const TorsoSensorParameters& sensor, hal::RobotWiring& wiring) {
  wiring.pitch_encoder_joint = sensor.encoder_joint;
  wiring.pitch_direction = sensor.encoder_reversed ? -1 : 1;
  wiring.pitch_offset_rad = sensor.encoder_offset_rad;
  wiring.pitch_ratio = sensor.encoder_ratio;
  wiring.rate_window_s = sensor.rate_window_s;
  switch (sensor.device) {
    case TorsoDevice::channels:
      if (sensor.encoder_joint >= 0) return;
      add_channel(sensor.pitch, BaseChannel::pitch_rad, wiring);
      add_channel(sensor.pitch_rate, BaseChannel::pitch_rate_rad_s, wiring);
      return;
    case TorsoDevice::canopen_encoder:
      wiring.pitch_encoder_bus = static_cast<std::uint8_t>(sensor.bus);
      wiring.pitch_encoder = {.node = static_cast<std::uint8_t>(sensor.encoder_node),
                              .steps_per_turn = static_cast<std::uint32_t>(sensor.encoder_steps),
                              .turns = static_cast<std::uint32_t>(sensor.encoder_turns),
                              .speed_rad_s = sensor.encoder_speed_rad_s};
      return;
    case TorsoDevice::xsens_can:
      add_xsens(sensor, wiring);
      return;
    case TorsoDevice::vectornav:
      wiring.serial_imu = {.by_roll = sensor.imu_axis == ImuAxis::roll,
                           .direction = sensor.imu_reversed ? -1.0 : 1.0,
                           .offset_rad = sensor.imu_offset_rad};
      return;
  }
}

void add_torso_sensor(const TorsoSensorParameters& sensor, hal::RobotWiring& wiring) {
  add_pitch(sensor, wiring);
  add_channel(sensor.acceleration_x, BaseChannel::acceleration_x_m_s2, wiring);
  add_channel(sensor.acceleration_z, BaseChannel::acceleration_z_m_s2, wiring);
  add_channel(sensor.left_foot_force, BaseChannel::left_foot_force_N, wiring);
  add_channel(sensor.right_foot_force, BaseChannel::right_foot_force_N, wiring);
  add_channel(sensor.emergency_stop_released, BaseChannel::emergency_stop_released, wiring);
  wiring.channel_bus = static_cast<std::uint8_t>(sensor.bus);
}

}  // namespace

const DriverParameters& driver_of(const HardwareParameters& hardware, std::size_t joint) {
  return joint % 2 == 0 ? hardware.hip : hardware.knee;
}

std::vector<std::string> bus_names(const HardwareParameters& hardware) {
  std::vector<std::string> names;
  std::string_view rest = hardware.buses;
  while (true) {
    const std::size_t comma = rest.find(',');
    std::string_view name = rest.substr(0, comma);
    while (name.starts_with(' ')) name.remove_prefix(1);
    while (name.ends_with(' ')) name.remove_suffix(1);
    names.emplace_back(name);
    if (comma == std::string_view::npos) return names;
    rest.remove_prefix(comma + 1);
  }
}

hal::RobotWiring robot_wiring(const HardwareParameters& hardware) {
  hal::RobotWiring wiring;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    wiring.joints[joint] = joint_wiring(hardware, joint);
  }
  add_torso_sensor(hardware.torso_sensor, wiring);
  wiring.driver_watchdog_s = hardware.driver_watchdog_s;
  wiring.emergency_stop_timeout_ns = std::llround(1e9 * hardware.torso_sensor.emergency_stop_timeout_s);
  return wiring;
}

int base_period_ticks(const HardwareParameters& hardware, double torque_rate_hz) {
  constexpr double kRounding = 1e-9;
  return std::max(1, static_cast<int>(std::ceil(torque_rate_hz / hardware.torso_sensor.rate_hz - kRounding)));
}

hal::RobotWiring robot_wiring(const HardwareParameters& hardware, double torque_rate_hz) {
  hal::RobotWiring wiring = robot_wiring(hardware);
  wiring.channel_period_ticks = base_period_ticks(hardware, torque_rate_hz);
  for (hal::JointWiring& joint : wiring.joints) {
    joint.report_period_ticks = hal::report_period_ticks(joint.driver, torque_rate_hz);
  }
  return wiring;
}

hal::bring_up::Options bring_up_options(const HardwareParameters& hardware, std::size_t joint,
                                        double minimum_rad, double maximum_rad, double speed_rad_s) {
  const DriverParameters& driver = driver_of(hardware, joint);
  const JointParameters& place = hardware.joint[joint];
  const double direction = place.reversed ? -1 : 1;
  const auto [first, last] = std::minmax({direction * driver.ratio * (minimum_rad - place.offset_rad),
                                          direction * driver.ratio * (maximum_rad - place.offset_rad)});
  hal::bring_up::Options options;
  options.watchdog_s = hardware.driver_watchdog_s;
  options.longest_reply_lag_ns = std::llround(1e9 * hardware.longest_reply_lag_s);
  options.accept_missing_watchdog = driver.accept_missing_watchdog;
  options.minimum_version = static_cast<std::uint32_t>(driver.minimum_version);
  options.minimum_angle_rad = first;
  options.maximum_angle_rad = last;
  options.maximum_speed_rad_s = driver.ratio * speed_rad_s;
  options.encoder_period_rad = driver.encoder_period_rad;
  return options;
}

hal::BusLoad bus_load(const HardwareParameters& hardware, std::size_t bus, double torque_rate_hz) {
  const std::vector<hal::PeriodicFrame> frames =
      hal::periodic_frames(robot_wiring(hardware), bus, torque_rate_hz, hardware.torso_sensor.rate_hz);
  return hal::bus_load(frames, {hardware.bit_rate_bit_s, hardware.data_bit_rate_bit_s});
}

}  // namespace stilt::configuration
