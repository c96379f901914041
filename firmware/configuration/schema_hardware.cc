#include <vector>

#include "firmware/configuration/channel_text.h"
#include "firmware/configuration/configuration.h"
#include "firmware/configuration/protocol_name.h"
#include "firmware/configuration/schema_fields.h"
#include "firmware/configuration/schema_tables.h"
#include "firmware/configuration/version_text.h"
#include "firmware/robots/robots.h"

namespace stilt::configuration {
namespace {

using namespace fields;
using B = TorsoSensorParameters;
using D = DriverParameters;
using H = HardwareParameters;
using J = JointParameters;
using P = Parameters;

constexpr std::string_view kProtocols[] = {"mit_mini_cheetah", "mit_ak", "mit_damiao",
                                           "moteus",           "odrive", "ak_v3"};
static_assert(static_cast<int>(DriverProtocol::ak_v3) == 5);

constexpr std::string_view kDevices[] = {"channels", "canopen_encoder", "xsens_can", "vectornav"};
static_assert(static_cast<int>(TorsoDevice::vectornav) == 3);
constexpr std::string_view kImuAxes[] = {"pitch", "roll"};
static_assert(static_cast<int>(ImuAxis::roll) == 1);

constexpr Section kSections[] = {
    {"hardware",
     "Buses and motor drivers. Hips have one kind of driver and knees one; numbers of buses count from 0."},
    {"hip_driver", "Motor drivers of the hips. Ranges must be those the drivers are set to."},
    {"knee_driver", "Motor drivers of the knees."},
    {"hip_L", "Wiring of the left hip: joint = direction shaft / ratio + offset."},
    {"knee_L", "Wiring of the left knee."},
    {"hip_R", "Wiring of the right hip."},
    {"knee_R", "Wiring of the right knee."},
    {"torso_sensor",
     "Sensors of the torso. A channel says which bits of which frame it is. It is \"none\", or words in any\n"
     "order: id N, extended, byte N, bit N, bits N; signed, unsigned or float. Further words are\n"
     "little or big, scale X, offset X, invalid N (raw value of a missing one)."},
};

std::optional<std::string> robot_mistake(const std::string& name) {
  const auto robot = robots::find(name);
  return robot ? std::nullopt : std::optional(robot.error());
}

std::optional<std::string> buses_mistake(const std::string& line) {
  HardwareParameters hardware;
  hardware.buses = line;
  const std::vector<std::string> names = bus_names(hardware);
  if (names.empty() || names.size() > hal::kMaximumBuses) {
    return "\"" + line + "\" names " + std::to_string(names.size()) +
           " buses; right are 1 to 4, separated by commas, such as \"can0,can1\"";
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::size_t blank = names[i].find_first_of(" \t");
    if (names[i].empty() || blank != std::string::npos) {
      return "\"" + names[i] +
             "\" is not the name of a bus; right is an interface such as can0, fdcanusb:/dev/PORT, or "
             "loopback:NAME";
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (names[j] == names[i]) return "names the bus " + names[i] + " twice";
    }
  }
  return std::nullopt;
}

std::optional<std::string> channel_mistake(const std::string& line) {
  const auto row = parse_channel(line, hal::BaseChannel::pitch_rad);
  return row ? std::nullopt : std::optional(row.error());
}

std::optional<std::string> port_mistake(const std::string& name) {
  if (name.starts_with('/')) return std::nullopt;
  return "\"" + name + "\" is no absolute path; right is one such as /dev/ttyUSB0";
}

constexpr std::string_view kVersionForm = "three numbers such as \"0.6.11\", or \"none\"";

std::optional<std::string> version_mistake(const std::string& text) {
  if (parse_version(text)) return std::nullopt;
  return "\"" + text + "\" is no version; right are three numbers such as \"0.6.11\", or \"none\"";
}

constexpr std::string_view kChannelForm = "a channel, or \"none\"";

template <auto Channel>
constexpr TextField channel() {
  return text<&P::hardware, &H::torso_sensor, Channel>(kChannelForm, channel_mistake);
}

template <auto Driver>
void add_driver(std::string_view section, std::vector<Entry>& rows) {
  const Entry driver[] = {
      {section, "protocol", "", "Protocol; MIT mode as the vendor defines it",
       choice<&P::hardware, Driver, &D::protocol>(kProtocols)},
      {section, "ratio", "1",
       "Turns of the shaft that the driver counts per turn of the joint; 1 when it counts its output",
       real<&P::hardware, Driver, &D::ratio>(0.01, 1e3)},
      {section, "position_range_rad", "rad", "MIT mode: positions reach from minus this to plus this",
       real<&P::hardware, Driver, &D::position_range_rad>(0.1, 1e3)},
      {section, "velocity_range_rad_s", "rad/s", "MIT mode: velocities, likewise",
       real<&P::hardware, Driver, &D::velocity_range_rad_s>(0.1, 1e4)},
      {section, "kp_range_Nm_rad", "Nm/rad",
       "MIT mode: kp reaches from 0 to this; 500 but for a mini-cheetah",
       real<&P::hardware, Driver, &D::kp_range_Nm_rad>(1e-3, 1e6)},
      {section, "kd_range_Nms_rad", "Nm s/rad",
       "MIT mode: kd reaches from 0 to this; 5 but for a mini-cheetah",
       real<&P::hardware, Driver, &D::kd_range_Nms_rad>(1e-3, 1e6)},
      {section, "torque_range_Nm", "Nm", "MIT mode: torques reach from minus this to plus this",
       real<&P::hardware, Driver, &D::torque_range_Nm>(0.1, 1e4)},
      {section, "reply_torque_range_Nm", "Nm",
       "MIT mode: torques in replies, likewise; as torque_range_Nm but for a mini-cheetah",
       real<&P::hardware, Driver, &D::reply_torque_range_Nm>(0.1, 1e4)},
      {section, "ak_temperature_offset_C", "C",
       "AK: its temperature is a byte of its reply and this; the vendor states -40",
       real<&P::hardware, Driver, &D::ak_temperature_offset_C>(-100.0, 100.0)},
      {section, "moteus_kp_Nm_rev", "Nm/rev",
       "moteus: its servo.pid_position.kp, the largest kp it can be asked for",
       real<&P::hardware, Driver, &D::moteus_kp_Nm_rev>(1e-3, 1e6)},
      {section, "moteus_kd_Nms_rev", "Nm s/rev",
       "moteus: its servo.pid_position.kd, the largest kd it can be asked for",
       real<&P::hardware, Driver, &D::moteus_kd_Nms_rev>(1e-4, 1e6)},
      {section, "can_fd", "", "Damiao, ODrive: set to exchange CAN FD frames; a moteus always does",
       flag<&P::hardware, Driver, &D::can_fd>()},
      {section, "bit_rate_switch", "", "CAN FD: data at data_bit_rate_bit_s",
       flag<&P::hardware, Driver, &D::bit_rate_switch>()},
      {section, "odrive_watchdog_timeout_endpoint", "1",
       "ODrive: number of axis0.config.watchdog_timeout in its firmware; 0: unknown",
       integer<&P::hardware, Driver, &D::odrive_watchdog_timeout_endpoint>(0, 65535)},
      {section, "odrive_enable_watchdog_endpoint", "1",
       "ODrive: number of axis0.config.enable_watchdog in its firmware; 0: unknown",
       integer<&P::hardware, Driver, &D::odrive_enable_watchdog_endpoint>(0, 65535)},
      {section, "odrive_torque_mode_limit_endpoint", "1",
       "ODrive: number of axis0.controller.config.enable_torque_mode_vel_limit; 0: unknown, not checked",
       integer<&P::hardware, Driver, &D::odrive_torque_mode_limit_endpoint>(0, 65535)},
      {section, "odrive_velocity_limit_endpoint", "1",
       "ODrive: number of axis0.controller.config.vel_limit; 0: unknown, not checked",
       integer<&P::hardware, Driver, &D::odrive_velocity_limit_endpoint>(0, 65535)},
      {section, "odrive_firmware_version", "",
       "ODrive: firmware that the endpoints are of, fw_version of its flat_endpoints.json",
       text<&P::hardware, Driver, &D::odrive_firmware_version>(kVersionForm, version_mistake)},
      {section, "odrive_hardware_version", "", "ODrive: hardware that the endpoints are of, hw_version there",
       text<&P::hardware, Driver, &D::odrive_hardware_version>(kVersionForm, version_mistake)},
      {section, "ak_v3_status_rate_hz", "Hz",
       "ak_v3: statuses per second, the CAN feedback rate that is set in the driver",
       real<&P::hardware, Driver, &D::ak_v3_status_rate_hz>(100.0, hal::ak::kAkMost_hz)},
      {section, "ak_v3_position_frames", "",
       "ak_v3: it also sends position frames (0x2A), ten times as fine as its statuses",
       flag<&P::hardware, Driver, &D::ak_v3_position_frames>()},
      {section, "ak_v3_pole_pairs", "1", "ak_v3: pole pairs of its motor, as its data sheet has them",
       integer<&P::hardware, Driver, &D::ak_v3_pole_pairs>(1, 100)},
      {section, "ak_v3_gear_ratio", "1", "ak_v3: gear ratio inside its motor",
       real<&P::hardware, Driver, &D::ak_v3_gear_ratio>(1.0, 1e3)},
      {section, "ak_v3_torque_constant_Nm_A", "Nm/A",
       "ak_v3: torque of its output per reported current, with the sign that fits; 0: no torque is read",
       real<&P::hardware, Driver, &D::ak_v3_torque_constant_Nm_A>(-100.0, 100.0)},
      {section, "encoder_period_rad", "rad",
       "The absolute encoder repeats after this angle of the shaft; 0: never",
       real<&P::hardware, Driver, &D::encoder_period_rad>(0.0, 1e3)},
      {section, "minimum_version", "1", "Oldest firmware that is accepted, vendor code; 0: any",
       integer<&P::hardware, Driver, &D::minimum_version>(0, 0xffffff)},
      {section, "accept_missing_watchdog", "",
       "Enable it even when it has no watchdog: it then drives on when the program ends",
       flag<&P::hardware, Driver, &D::accept_missing_watchdog>()},
  };
  rows.insert(rows.end(), std::begin(driver), std::end(driver));
}

template <std::size_t Joint>
void add_joint(std::string_view section, std::vector<Entry>& rows) {
  const Entry joint[] = {
      {section, "bus", "1", "Number of its bus", integer<&P::hardware, &H::joint, Joint, &J::bus>(0, 3)},
      {section, "id", "1", "Identifier of the driver's commands; ODrive: its node",
       integer<&P::hardware, &H::joint, Joint, &J::id>(0, 0x7ff)},
      {section, "reply_id", "1", "MIT mode: identifier it answers with",
       integer<&P::hardware, &H::joint, Joint, &J::reply_id>(0, 0x7ff)},
      {section, "reversed", "", "The shaft turns against the joint",
       flag<&P::hardware, &H::joint, Joint, &J::reversed>()},
      {section, "offset_rad", "rad", "Angle of the joint where the shaft reads 0",
       real<&P::hardware, &H::joint, Joint, &J::offset_rad>(-100.0, 100.0)},
      {section, "torque_factor", "1",
       "Torque that the motor gives per torque asked of its driver; stiltd identify finds it",
       real<&P::hardware, &H::joint, Joint, &J::torque_factor>(kLeastTorqueFactor, kMostTorqueFactor)},
  };
  rows.insert(rows.end(), std::begin(joint), std::end(joint));
}

const Entry kHardware[] = {
    {"hardware", "robot", "",
     "The robot: the name of a shipped one, or a URDF file, found from this file's folder",
     text<&P::hardware, &H::robot>("the name of a robot or a file that ends in .urdf", robot_mistake)},
    {"hardware", "buses", "",
     "Names of the buses, separated by commas: interfaces such as can0, fdcanusb:/dev/PORT, or loopback:NAME",
     text<&P::hardware, &H::buses>("1 to 4 names", buses_mistake)},
    {"hardware", "bit_rate_bit_s", "bit/s", "Bit rate of every bus",
     real<&P::hardware, &H::bit_rate_bit_s>(1e4, 1e6)},
    {"hardware", "data_bit_rate_bit_s", "bit/s", "CAN FD: bit rate of the data phase",
     real<&P::hardware, &H::data_bit_rate_bit_s>(1e4, 1e7)},
    {"hardware", "driver_watchdog_s", "s", "Time without commands after which a driver disables itself",
     real<&P::hardware, &H::driver_watchdog_s>(0.005, 0.1)},
    {"hardware", "longest_reply_lag_s", "s",
     "From a request to the tick that receives a driver's reply, at bring-up; later, and it is refused",
     real<&P::hardware, &H::longest_reply_lag_s>(0.001, 0.1)},
};

constexpr int kMostEncoderTurns = 65536;
constexpr double kLeastEncoderRatio = 0.01;
/// Half of the angle after which the pitch of such an encoder repeats, pi kMostEncoderTurns /
/// kLeastEncoderRatio. Where an absolute encoder counts from is anywhere in its turns.
constexpr double kMostEncoderOffset_rad = 2.1e7;

const Entry kTorsoSensor[] = {
    {"torso_sensor", "device", "",
     "What measures pitch and pitch rate: the channels below (or encoder_joint), an absolute CANopen\n"
     "encoder, an Xsens MTi on CAN, a serial VectorNav",
     choice<&P::hardware, &H::torso_sensor, &B::device>(kDevices)},
    {"torso_sensor", "bus", "1", "Number of its bus", integer<&P::hardware, &H::torso_sensor, &B::bus>(0, 3)},
    {"torso_sensor", "rate_hz", "Hz", "Frames per second of each identifier",
     real<&P::hardware, &H::torso_sensor, &B::rate_hz>(1.0, 1e4)},
    {"torso_sensor", "rate_window_s", "s",
     "Where nothing measures the pitch rate: it is the mean of so long, and late by half of it",
     real<&P::hardware, &H::torso_sensor, &B::rate_window_s>(0.002, 0.05)},
    {"torso_sensor", "pitch", "", "Pitch of the torso, rad, positive leans forward", channel<&B::pitch>()},
    {"torso_sensor", "pitch_rate", "", "Its rate, rad/s", channel<&B::pitch_rate>()},
    {"torso_sensor", "acceleration_x", "", "Specific force along the torso's x, m/s^2",
     channel<&B::acceleration_x>()},
    {"torso_sensor", "acceleration_z", "", "Specific force along the torso's z, m/s^2",
     channel<&B::acceleration_z>()},
    {"torso_sensor", "left_foot_force", "",
     "Normal force of the left foot, N; recorded, no controller uses it", channel<&B::left_foot_force>()},
    {"torso_sensor", "right_foot_force", "",
     "Normal force of the right foot, N; recorded, no controller uses it", channel<&B::right_foot_force>()},
    {"torso_sensor", "emergency_stop_released", "", "Not 0 while the emergency stop is released",
     channel<&B::emergency_stop_released>()},
    {"torso_sensor", "emergency_stop_timeout_s", "s",
     "An emergency stop that is silent for so long counts as pressed",
     real<&P::hardware, &H::torso_sensor, &B::emergency_stop_timeout_s>(0.002, 0.5)},
    {"torso_sensor", "encoder_joint", "1",
     "Joint (0 to 3) whose moteus reads the pitch with an extra encoder; -1: none",
     integer<&P::hardware, &H::torso_sensor, &B::encoder_joint>(-1, 3)},
    {"torso_sensor", "encoder_number", "1", "Number of that encoder",
     integer<&P::hardware, &H::torso_sensor, &B::encoder_number>(0, 2)},
    {"torso_sensor", "encoder_reversed", "", "It turns against the pitch",
     flag<&P::hardware, &H::torso_sensor, &B::encoder_reversed>()},
    {"torso_sensor", "encoder_offset_rad", "rad", "Pitch where it reads 0",
     real<&P::hardware, &H::torso_sensor, &B::encoder_offset_rad>(-kMostEncoderOffset_rad,
                                                                  kMostEncoderOffset_rad)},
    {"torso_sensor", "encoder_ratio", "1", "Turns of the encoder per turn of the torso",
     real<&P::hardware, &H::torso_sensor, &B::encoder_ratio>(kLeastEncoderRatio, 1e3)},
    {"torso_sensor", "encoder_node", "1", "canopen_encoder: its node",
     integer<&P::hardware, &H::torso_sensor, &B::encoder_node>(1, hal::canopen::kMaximumNode)},
    {"torso_sensor", "encoder_steps", "1", "canopen_encoder: steps of a turn",
     integer<&P::hardware, &H::torso_sensor, &B::encoder_steps>(2, 1 << 30)},
    {"torso_sensor", "encoder_turns", "1", "canopen_encoder: turns after which its position repeats",
     integer<&P::hardware, &H::torso_sensor, &B::encoder_turns>(1, kMostEncoderTurns)},
    {"torso_sensor", "encoder_speed_rad_s", "rad/s",
     "canopen_encoder: speed of its shaft that is 1 in object 0x6030; 0: that is not read",
     real<&P::hardware, &H::torso_sensor, &B::encoder_speed_rad_s>(0.0, 100.0)},
    {"torso_sensor", "imu_axis", "",
     "xsens_can, vectornav: the axis that is parallel to the torso's pitch axis, its y (pitch) or its x "
     "(roll)",
     choice<&P::hardware, &H::torso_sensor, &B::imu_axis>(kImuAxes)},
    {"torso_sensor", "imu_reversed", "", "xsens_can, vectornav: that axis points the other way",
     flag<&P::hardware, &H::torso_sensor, &B::imu_reversed>()},
    {"torso_sensor", "imu_offset_rad", "rad", "xsens_can, vectornav: pitch of the torso where it reads 0",
     real<&P::hardware, &H::torso_sensor, &B::imu_offset_rad>(-3.2, 3.2)},
    {"torso_sensor", "serial_port", "", "vectornav: its port",
     text<&P::hardware, &H::torso_sensor, &B::serial_port>("an absolute path", port_mistake)},
    {"torso_sensor", "serial_baud", "bit/s", "vectornav: bit rate of its port",
     integer<&P::hardware, &H::torso_sensor, &B::serial_baud>(9600, 921600)},
};

}  // namespace

std::string_view name(DriverProtocol protocol) noexcept { return kProtocols[static_cast<int>(protocol)]; }

std::span<const Section> hardware_sections() { return kSections; }

std::span<const Entry> hardware_entries() {
  static const std::vector<Entry> all = [] {
    std::vector<Entry> rows(std::begin(kHardware), std::end(kHardware));
    add_driver<&H::hip>("hip_driver", rows);
    add_driver<&H::knee>("knee_driver", rows);
    add_joint<0>("hip_L", rows);
    add_joint<1>("knee_L", rows);
    add_joint<2>("hip_R", rows);
    add_joint<3>("knee_R", rows);
    rows.insert(rows.end(), std::begin(kTorsoSensor), std::end(kTorsoSensor));
    return rows;
  }();
  return all;
}

}  // namespace stilt::configuration
