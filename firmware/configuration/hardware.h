#pragma once

#include <array>
#include <string>
#include <vector>

#include "hal/bring_up/bring_up.h"
#include "hal/can/bus_load.h"
#include "hal/robot/robot_wiring.h"

/// The hardware of a robot as its configuration names it: buses, motor drivers, wiring of the joints, sensors
/// of the torso. Start-up and host programs only.
namespace stilt::configuration {

/// Protocol of a motor driver; the MIT mode as its vendor defines it.
enum class DriverProtocol { mit_mini_cheetah, mit_ak, mit_damiao, moteus, odrive, ak_v3 };

/// What measures the pitch of the torso. Channels of frames (or the extra encoder of a moteus), a CANopen
/// encoder, an Xsens MTi on CAN, a VectorNav on a serial port.
enum class TorsoDevice { channels, canopen_encoder, xsens_can, vectornav };

/// Axis of an inertial measurement unit that is parallel to the pitch axis of the torso: its y, or its x.
enum class ImuAxis { pitch, roll };

/// A kind of motor driver. Hips have one kind and knees one; left and right are the same.
struct DriverParameters {
  DriverProtocol protocol = DriverProtocol::mit_damiao;
  double ratio = 1.0;  ///< turns of the shaft the driver counts per turn of the joint
  /// MIT mode: ranges of the command, +- but for the gains, which start at 0. The reply has the same ranges
  /// but for the torque's.
  double position_range_rad = 3.2;
  double velocity_range_rad_s = 20.0;
  double kp_range_Nm_rad = 500.0;
  double kd_range_Nms_rad = 5.0;
  double torque_range_Nm = 120.0;
  double reply_torque_range_Nm = 120.0;
  double ak_temperature_offset_C = -40.0;  ///< added to the byte in which an AK reports its temperature
  /// moteus: the gains of its own configuration, at gain scale 1: the largest it can be asked for; and
  /// whether its data phase is faster.
  double moteus_kp_Nm_rev = 800.0;
  double moteus_kd_Nms_rev = 40.0;
  bool can_fd = false;
  bool bit_rate_switch = true;
  /// ODrive: numbers of four parameters in its firmware; 0: unknown. With the versions of the file they are
  /// of.
  int odrive_watchdog_timeout_endpoint = 0;
  int odrive_enable_watchdog_endpoint = 0;
  int odrive_torque_mode_limit_endpoint = 0;
  int odrive_velocity_limit_endpoint = 0;
  std::string odrive_firmware_version = "none";
  std::string odrive_hardware_version = "none";
  /// AK of version 3: what it is set to, and what its motor is.
  double ak_v3_status_rate_hz = 500.0;
  bool ak_v3_position_frames = false;
  int ak_v3_pole_pairs = 21;
  double ak_v3_gear_ratio = 9.0;
  double ak_v3_torque_constant_Nm_A = 0.0;  ///< of the output; 0: no torque is read
  double encoder_period_rad = 0.0;          ///< of the shaft; 0: the encoder does not repeat
  int minimum_version = 0;
  bool accept_missing_watchdog = false;
};

/// Beyond it is a wrong ratio, or a driver that is set up for another motor.
inline constexpr double kLeastTorqueFactor = 0.5, kMostTorqueFactor = 2.0;

/// One joint's place on the buses: joint = direction shaft / ratio + offset.
struct JointParameters {
  int bus = 0;
  int id = 1;                  ///< of the driver's commands; moteus: its id, ODrive: its node
  int reply_id = 0;            ///< MIT mode: identifier it answers with
  bool reversed = false;       ///< direction -1
  double offset_rad = 0.0;     ///< of the joint where the shaft reads 0
  double torque_factor = 1.0;  ///< torque that the motor gives per torque asked of the driver
};

/// Where the sensors of the torso are. A channel is a line of text, see parse_channel(); "none" without one.
struct TorsoSensorParameters {
  TorsoDevice device = TorsoDevice::channels;
  int bus = 0;
  double rate_hz = 500.0;
  double rate_window_s = 0.01;  ///< hal::TorsoSensorTraits, where nothing measures the pitch rate
  std::string pitch = "id 0x150 byte 0 bits 24 signed little scale 1e-6";
  std::string pitch_rate = "id 0x150 byte 3 bits 16 signed little scale 5e-4";
  std::string acceleration_x = "none";
  std::string acceleration_z = "none";
  std::string left_foot_force = "none";
  std::string right_foot_force = "none";
  std::string emergency_stop_released = "id 0x150 byte 5 bits 1 unsigned little scale 1";
  double emergency_stop_timeout_s = 0.1;
  int encoder_joint = -1;  ///< joint whose moteus reads the pitch with an extra encoder; -1: none
  int encoder_number = 1;  ///< of that moteus, 0 to 2
  bool encoder_reversed = false;
  double encoder_offset_rad = 0.0;
  double encoder_ratio = 1.0;        ///< turns of the encoder per turn of the torso
  int encoder_node = 32;             ///< of CANopen, 1 to 127
  int encoder_steps = 65536;         ///< of a turn
  int encoder_turns = 1;             ///< after which its position repeats
  double encoder_speed_rad_s = 0.0;  ///< of its shaft, a unit of object 0x6030; 0: that is not read
  ImuAxis imu_axis = ImuAxis::pitch;
  bool imu_reversed = false;
  double imu_offset_rad = 0.0;  ///< pitch where the unit reads 0
  std::string serial_port = "/dev/ttyUSB0";
  int serial_baud = 921600;
};

/// Everything on the far side of the buses.
struct HardwareParameters {
  std::string robot = "amber3m";    ///< name of a shipped robot, or a URDF file
  std::string buses = "can0,can1";  ///< names, in the order of their numbers
  double bit_rate_bit_s = 1e6;
  double data_bit_rate_bit_s = 5e6;
  double driver_watchdog_s = 0.02;
  double longest_reply_lag_s = 0.003;  ///< at bring-up, from a request to the tick that receives its reply
  DriverParameters hip;
  DriverParameters knee;
  /// hip_L, knee_L, hip_R, knee_R.
  std::array<JointParameters, hal::kJoints> joint = {
      JointParameters{.bus = 0, .id = 1, .reply_id = 0x11, .reversed = false, .offset_rad = 0},
      JointParameters{.bus = 0, .id = 2, .reply_id = 0x12, .reversed = false, .offset_rad = 0},
      JointParameters{.bus = 1, .id = 3, .reply_id = 0x13, .reversed = true, .offset_rad = 0},
      JointParameters{.bus = 1, .id = 4, .reply_id = 0x14, .reversed = true, .offset_rad = 0}};
  TorsoSensorParameters torso_sensor;
};

/// Names of the buses, without blanks around them.
[[nodiscard]] std::vector<std::string> bus_names(const HardwareParameters& hardware);

/// The wiring as the hardware abstraction takes it; hal::valid() for a configuration that was accepted.
/// Periods are one tick: what reads a robot takes the wiring of its torque rate.
[[nodiscard]] hal::RobotWiring robot_wiring(const HardwareParameters& hardware);

/// The same with the periods, in ticks of the torque loop, of the torso sensor and of drivers that report by
/// their own clock.
[[nodiscard]] hal::RobotWiring robot_wiring(const HardwareParameters& hardware, double torque_rate_hz);

/// Ticks of the torque loop from one frame of the torso sensor to the next.
[[nodiscard]] int base_period_ticks(const HardwareParameters& hardware, double torque_rate_hz);

/// What the bring-up of a joint's driver shall require.
/// @param minimum_rad, maximum_rad  travel of the joint, margin included
/// @param speed_rad_s               that the joint may reach; 0: its driver's limit is not checked
[[nodiscard]] hal::bring_up::Options bring_up_options(const HardwareParameters& hardware, std::size_t joint,
                                                      double minimum_rad, double maximum_rad,
                                                      double speed_rad_s = 0);

/// Worst-case load of a bus with the torque loop at this rate.
[[nodiscard]] hal::BusLoad bus_load(const HardwareParameters& hardware, std::size_t bus,
                                    double torque_rate_hz);

}  // namespace stilt::configuration
