#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <string>

#include "firmware/configuration/driver_of.h"
#include "firmware/configuration/hardware_consistency.h"
#include "firmware/configuration/schema.h"
#include "firmware/control_loop/sensor_reading.h"
#include "hal/robot/robot_wiring.h"
#include "hal/serial/serial_port.h"

namespace stilt::configuration {
namespace {

using hal::BaseChannel;

/// A torso that tips over gets about as fast before it is at supervisor.base_pitch_limit_rad.
constexpr double kFallingTorso_rad_s = 5.0;
/// Step of a rate that is taken from the pitch: more would be noise in the torques.
constexpr double kCoarsestRate_rad_s = 0.03;
constexpr double kFastestXsens_Hz = 400.0;  // its fused angles; MT Low Level Communication Protocol
constexpr double kFewestPitches = 2, kMostPitches = 60;  // of hal::TorsoMeasurement, in a window

/// Farthest that a field reads, either way.
double reach(const hal::ChannelRow& row) {
  if (row.type == hal::RawType::float32) return HUGE_VAL;
  const bool is_signed = row.type == hal::RawType::signed_integer;
  const double span = std::ldexp(1.0, row.bits);
  const double lowest = is_signed ? -span / 2 : 0, highest = lowest + span - 1;
  const double a = row.scale * lowest + row.offset, b = row.scale * highest + row.offset;
  return std::min(-std::min(a, b), std::max(a, b));
}

const hal::ChannelRow* row_of(const hal::RobotWiring& wiring, BaseChannel channel) {
  for (std::size_t i = 0; i < wiring.channel_count; ++i) {
    if (wiring.channels[i].channel == channel) return &wiring.channels[i];
  }
  return nullptr;
}

void check_reach(std::string_view key, double carried, double wanted, std::string_view unit,
                 std::string_view why, std::vector<Contradiction>& found) {
  if (carried >= wanted) return;
  found.push_back({{key},
                   std::string(key) + " carries at most " + number_text(std::max(carried, 0.0)) + ' ' +
                       std::string(unit) + " either way, and must carry " + number_text(wanted) + ' ' +
                       std::string(unit) + ", " + std::string(why)});
}

/// Where the rate is taken from the pitch: whether the window holds enough of them, and fine ones.
void check_window(const HardwareParameters& hardware, std::vector<Contradiction>& found) {
  const TorsoSensorParameters& sensor = hardware.torso_sensor;
  const double pitches = sensor.rate_window_s * sensor.rate_hz;
  constexpr double kRounding = 1e-9;
  if (pitches < kFewestPitches - kRounding || pitches > kMostPitches + kRounding) {
    found.push_back({{"torso_sensor.rate_window_s", "torso_sensor.rate_hz"},
                     "torso_sensor.rate_window_s = " + number_text(sensor.rate_window_s) + " holds " +
                         number_text(pitches) + " pitches at torso_sensor.rate_hz = " +
                         number_text(sensor.rate_hz) + "; nothing measures the pitch rate, which takes " +
                         number_text(kFewestPitches) + " to " + number_text(kMostPitches)});
  }
  const hal::RobotWiring wiring = robot_wiring(hardware);
  const hal::ChannelRow* row = row_of(wiring, BaseChannel::pitch_rad);
  const bool is_encoder = wiring.pitch_encoder.has_value();
  if (!is_encoder && (row == nullptr || row->type == hal::RawType::float32)) return;
  const double step_rad =
      is_encoder ? 2 * std::numbers::pi / sensor.encoder_steps / sensor.encoder_ratio : std::abs(row->scale);
  const double rate_rad_s = step_rad / sensor.rate_window_s;
  if (rate_rad_s <= kCoarsestRate_rad_s) return;
  found.push_back(
      {{is_encoder ? "torso_sensor.encoder_steps" : "torso_sensor.pitch", "torso_sensor.rate_window_s"},
       "nothing measures the pitch rate, and one from pitches in steps of " + number_text(step_rad) +
           " rad over torso_sensor.rate_window_s has steps of " + number_text(rate_rad_s) +
           " rad/s, more than " + number_text(kCoarsestRate_rad_s) +
           "; take a finer sensor, gears before it, or one that measures the rate"});
}

void check_encoder_joint(const HardwareParameters& hardware, std::vector<Contradiction>& found) {
  const TorsoSensorParameters& sensor = hardware.torso_sensor;
  if (sensor.encoder_joint < 0) return;
  const std::string value = "torso_sensor.encoder_joint = " + std::to_string(sensor.encoder_joint);
  if (driver_of(hardware, static_cast<std::size_t>(sensor.encoder_joint)).protocol !=
      DriverProtocol::moteus) {
    found.push_back({{"torso_sensor.encoder_joint"},
                     value + ": only a moteus has extra encoders, that joint has another driver"});
  }
  if (sensor.device != TorsoDevice::channels) {
    found.push_back({{"torso_sensor.device", "torso_sensor.encoder_joint"},
                     value +
                         ", and torso_sensor.device is another sensor; -1 leaves the encoder out, device = "
                         "\"channels\" the other"});
  }
}

/// Whether a frame means "pressed": it is read as released for every value but 0.
void check_emergency_stop(const HardwareParameters& hardware, std::vector<Contradiction>& found) {
  constexpr std::string_view kKey = "torso_sensor.emergency_stop_released";
  constexpr auto kChannel = BaseChannel::emergency_stop_released;
  const hal::RobotWiring wiring = robot_wiring(hardware);
  const hal::ChannelRow* row = row_of(wiring, kChannel);
  if (row == nullptr) return;
  hal::CanFrame frame = {.id = row->id, .length = hal::kMaximumFrameBytes, .extended = row->extended};
  hal::ChannelValues pressed;
  const bool carried = encode(*row, 0, frame) == hal::EncodeStatus::ok &&
                       decode({row, 1}, frame, pressed) == hal::DecodeStatus::ok;
  if (carried && !pressed.has(kChannel)) {
    found.push_back({{kKey},
                     std::string(kKey) +
                         " has the raw value of a pressed emergency stop as invalid: it would "
                         "never be seen; leave \"invalid\" out"});
  } else if (!carried || pressed[kChannel] != 0) {
    found.push_back({{kKey},
                     std::string(kKey) + " is 0 for no raw value: a pressed emergency stop would never be "
                                         "seen; give \"scale 1\" without an offset, or \"scale -1 offset 1\" "
                                         "for a bit that is 1 while it is pressed"});
  }
}

/// Whether the next pitch comes before the controller ends the extrapolation of the last one.
void check_rate(const TorsoSensorParameters& sensor, std::vector<Contradiction>& found) {
  constexpr double kLeast_hz = 1e9 / control_loop::kLongestExtrapolation_ns;
  if (sensor.encoder_joint >= 0 || sensor.rate_hz >= kLeast_hz) return;
  found.push_back({{"torso_sensor.rate_hz"},
                   "torso_sensor.rate_hz = " + number_text(sensor.rate_hz) + " must be at least " +
                       number_text(kLeast_hz) +
                       ": the pitch is extrapolated until the next one, for 10 ms at most"});
}

/// Whether the port has that bit rate, and time for the messages.
void check_port(const TorsoSensorParameters& sensor, std::vector<Contradiction>& found) {
  const std::span<const int> rates = hal::serial::bit_rates();
  const std::string baud = "torso_sensor.serial_baud = " + std::to_string(sensor.serial_baud);
  if (std::ranges::find(rates, sensor.serial_baud) == rates.end()) {
    std::string right;
    for (const int rate : rates) right += (right.empty() ? "" : ", ") + std::to_string(rate);
    found.push_back(
        {{"torso_sensor.serial_baud"}, baud + " is no bit rate of the sensor; right are " + right});
    return;
  }
  constexpr double kBitsAByte = 10, kUsable = 0.9;
  const double most_hz = kUsable * sensor.serial_baud / kBitsAByte / hal::vectornav::kPacketBytes;
  if (sensor.rate_hz <= most_hz) return;
  found.push_back({{"torso_sensor.rate_hz", "torso_sensor.serial_baud"},
                   baud + " carries at most " + number_text(std::floor(most_hz)) +
                       " messages per second, and torso_sensor.rate_hz is " + number_text(sensor.rate_hz)});
}

}  // namespace

void check_torso_sensor(const HardwareParameters& hardware, std::vector<Contradiction>& found) {
  const TorsoSensorParameters& sensor = hardware.torso_sensor;
  check_encoder_joint(hardware, found);
  check_emergency_stop(hardware, found);
  check_rate(sensor, found);
  const bool by_channel = sensor.device == TorsoDevice::channels && sensor.encoder_joint < 0;
  if (by_channel && sensor.pitch == "none") {
    found.push_back({{"torso_sensor.pitch", "torso_sensor.device"},
                     "nothing measures the pitch of the torso; give torso_sensor.pitch a channel, "
                     "torso_sensor.device a sensor, or torso_sensor.encoder_joint a moteus with an extra "
                     "encoder"});
    return;
  }
  const bool is_encoder = sensor.device == TorsoDevice::canopen_encoder;
  if (is_encoder && std::ldexp(1.0, 32) < static_cast<double>(sensor.encoder_steps) * sensor.encoder_turns) {
    found.push_back({{"torso_sensor.encoder_steps", "torso_sensor.encoder_turns"},
                     "torso_sensor.encoder_steps times torso_sensor.encoder_turns must be at most 2^32, the "
                     "positions of an encoder on CANopen"});
    return;
  }
  if (sensor.device == TorsoDevice::xsens_can && sensor.rate_hz > kFastestXsens_Hz) {
    found.push_back({{"torso_sensor.rate_hz", "torso_sensor.device"},
                     "torso_sensor.rate_hz = " + number_text(sensor.rate_hz) +
                         ", and an Xsens MTi sends at most " + number_text(kFastestXsens_Hz) +
                         " angles per second"});
  }
  if (sensor.device == TorsoDevice::vectornav) check_port(sensor, found);
  const bool rate_from_pitch =
      (by_channel && sensor.pitch_rate == "none") || (is_encoder && sensor.encoder_speed_rad_s == 0);
  if (rate_from_pitch) check_window(hardware, found);
}

void check_torso_range(const HardwareParameters& hardware, const supervisor::SupervisorParameters& supervisor,
                       std::vector<Contradiction>& found) {
  const TorsoSensorParameters& sensor = hardware.torso_sensor;
  const hal::RobotWiring wiring = robot_wiring(hardware);
  const double angle_rad = supervisor.base_pitch_limit_rad;
  constexpr std::string_view kAngle = "supervisor.base_pitch_limit_rad";
  constexpr std::string_view kRate = "which a torso that falls reaches";
  if (sensor.device == TorsoDevice::channels) {
    if (const hal::ChannelRow* row = row_of(wiring, BaseChannel::pitch_rad))
      check_reach("torso_sensor.pitch", reach(*row), angle_rad, "rad", kAngle, found);
    if (const hal::ChannelRow* row = row_of(wiring, BaseChannel::pitch_rate_rad_s))
      check_reach("torso_sensor.pitch_rate", reach(*row), kFallingTorso_rad_s, "rad/s", kRate, found);
  }
  const bool is_unit = sensor.device == TorsoDevice::xsens_can || sensor.device == TorsoDevice::vectornav;
  // Its pitch turns back at a quarter turn; its roll goes on.
  if (is_unit && sensor.imu_axis == ImuAxis::pitch) {
    check_reach("torso_sensor.imu_axis", std::numbers::pi / 2 - std::abs(sensor.imu_offset_rad), angle_rad,
                "rad", kAngle, found);
  }
  const double period_rad = hal::torso_sensor_traits(wiring).pitch_period_rad;
  const bool is_encoder = wiring.pitch_encoder || wiring.pitch_encoder_joint >= 0;
  if (period_rad > 0 && is_encoder)
    check_reach("torso_sensor.encoder_ratio", period_rad / 2, angle_rad, "rad", kAngle, found);
  if (wiring.pitch_encoder && sensor.encoder_speed_rad_s > 0) {
    const double fastest_rad_s = std::ldexp(1.0, 15) * sensor.encoder_speed_rad_s / sensor.encoder_ratio;
    check_reach("torso_sensor.encoder_speed_rad_s", fastest_rad_s, kFallingTorso_rad_s, "rad/s", kRate,
                found);
  }
}

}  // namespace stilt::configuration
