#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "hal/canopen/encoder.h"
#include "hal/robot/joint_bus.h"
#include "hal/robot/joint_driver.h"
#include "hal/sensors/torso_measurement.h"
#include "hal/sensors/torso_sensor_table.h"
#include "hal/vectornav/vectornav.h"

namespace stilt::hal {

inline constexpr std::size_t kMaximumBuses = 4;
inline constexpr std::size_t kMaximumChannels = 16;

/// Where a joint's driver is and how its shaft relates to the joint:
///
///   joint = direction * shaft / ratio + offset_rad,  torque_joint = direction * ratio * torque_shaft
///
/// where shaft includes the encoder's periods that bring-up found (encoder_period_rad), and gains at the
/// shaft are those of the joint divided by ratio^2 torque_factor.
struct JointWiring {
  std::uint8_t bus = 0;
  JointDriver driver;
  double direction = 1;  ///< 1 or -1
  double ratio =
      1;  ///< turns of the driver's shaft per turn of the joint; 1 when the driver counts its output
  double offset_rad = 0;
  double torque_factor = 1;  ///< torque that the motor gives per torque asked of the driver
  int report_period_ticks =
      1;                ///< reads within which the driver must have reported, see report_period_ticks()
  bool can_fd = false;  ///< the driver's classic frames travel as CAN FD frames: FlexibleFrames
  bool bit_rate_switch = true;  ///< and their data at the faster bit rate
};

/// Reads within which a driver has reported that is well: 1 of one that answers each command. One that
/// reports by its own clock (report_rate_hz) gets its period and one read more, since it drifts against ours.
[[nodiscard]] int report_period_ticks(const JointDriver& driver, double tick_hz) noexcept;

/// Whether a driver reports by its own clock, also while no command reaches it.
[[nodiscard]] bool reports_by_itself(const JointDriver& driver) noexcept;

/// Number of the extra encoder that the joint's driver reports; -1: none.
[[nodiscard]] int extra_encoder_of(const JointWiring& joint) noexcept;

/// What is on which bus. Checked by valid().
struct RobotWiring {
  std::array<JointWiring, kJoints> joints;
  std::array<ChannelRow, kMaximumChannels> channels{};
  std::size_t channel_count = 0;
  std::uint8_t channel_bus = 0;
  int channel_period_ticks = 1;         ///< reads from one value of the torso sensor to the next
  double channel_pitch_period_rad = 0;  ///< a pitch from channels repeats after this; 0: never
  /// What measures the pitch, when it is no channel. It is an extra encoder that this joint's driver reports
  /// (-1: none), an encoder on CANopen, or a unit on a serial port. Of encoders, pitch = direction * angle /
  /// ratio + offset.
  int pitch_encoder_joint = -1;
  std::optional<canopen::Encoder> pitch_encoder;
  std::uint8_t pitch_encoder_bus = 0;
  std::optional<vectornav::Mounting> serial_imu;
  double pitch_direction = 1;
  double pitch_ratio = 1;  ///< turns of the encoder per turn of the torso
  double pitch_offset_rad = 0;
  double rate_window_s = 0.01;      ///< TorsoSensorTraits, where nothing measures the pitch rate
  double driver_watchdog_s = 0.02;  ///< in every moteus command
  std::int64_t emergency_stop_timeout_ns = 100'000'000;
};

/// How the pitch is measured.
[[nodiscard]] TorsoSensorTraits torso_sensor_traits(const RobotWiring& wiring) noexcept;

/// Whether pitch and pitch rate are channels.
[[nodiscard]] bool pitch_is_channel(const RobotWiring& wiring) noexcept;

/// Buses exist, directions are 1 or -1, ratios positive, drivers and channels valid, and no two joints share
/// a driver's identifier on a bus.
[[nodiscard]] bool valid(const RobotWiring& wiring, std::size_t bus_count) noexcept;

}  // namespace stilt::hal
