#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "hal/can/frame_bus.h"
#include "hal/canopen/encoder.h"
#include "hal/robot/joint_bus.h"
#include "hal/robot/robot_wiring.h"
#include "hal/sensors/emergency_stop.h"
#include "hal/sensors/torso_feed.h"
#include "hal/sensors/torso_measurement.h"
#include "hal/sensors/torso_sensor.h"

namespace stilt::hal {

/// Four joints, torso sensor and emergency stop over one or more buses, whatever drives them. Decodes what
/// arrives, encodes what is commanded. Drivers without gains of their own (ODrive) get the torque of the
/// command's law at the newest reading. They get no torque before the first, and no feedback from one that is
/// more than a few ticks old. They are asked for supply and temperatures now and then. Fixed memory; no call
/// waits, allocates, locks or throws.
class CanRobot final {
 public:
  /// @param wiring  valid for this many buses
  /// @param buses   at most kMaximumBuses, outlive this object
  CanRobot(const RobotWiring& wiring, std::span<FrameBus* const> buses) noexcept;

  /// Takes everything that has arrived. Values of joints without news stay as they were.
  [[nodiscard]] JointBusStatus read(std::int64_t now_ns, JointReadings& readings) noexcept;
  /// Sends all four commands, in one batch per bus.
  [[nodiscard]] JointBusStatus write(const JointCommands& commands) noexcept;
  /// Disables every driver. Sent even after refused commands.
  [[nodiscard]] JointBusStatus disable() noexcept;
  /// Clears what a driver keeps until it is cleared: of those that report a fault or are silent. They are off
  /// then; the others go on with their commands.
  void clear_faults() noexcept;
  /// Newest reading of the torso. Call after read(): both share the buses.
  [[nodiscard]] TorsoSensorStatus read_base(BaseReading& reading) noexcept;
  [[nodiscard]] EmergencyStopState read_emergency_stop(std::int64_t now_ns) noexcept;
  /// Takes the torso sensor's samples from here. At start-up; outlives this object.
  void attach(TorsoFeed& feed) noexcept { feed_ = &feed; }
  /// Sends what a torso sensor must be asked for. Once per read, after it.
  void serve_torso_sensor(std::int64_t now_ns) noexcept;
  /// Why the torso sensor does not report, as far as it reports that. From any thread.
  [[nodiscard]] canopen::EncoderTrouble torso_sensor_trouble() const noexcept {
    return encoder_ ? encoder_->trouble() : canopen::EncoderTrouble{};
  }

  /// Reads in a row without a new position of the joint since one was due, whatever left for its driver.
  [[nodiscard]] std::uint32_t missed_reports(std::size_t joint) const noexcept;

  /// Whether the joint's driver reported in the newest read that it had no power. Most do not report that.
  [[nodiscard]] bool has_started(std::size_t joint) const noexcept { return started_[joint]; }

  /// Whole encoder periods found at bring-up, at the driver's shaft (StepResult::turn_offset_rad).
  void set_turn_offset(std::size_t joint, double shaft_rad) noexcept { turn_offset_rad_[joint] = shaft_rad; }

 private:
  void receive(std::int64_t now_ns, std::size_t bus, const CanFrame& frame) noexcept;
  [[nodiscard]] DecodeStatus take_joint(std::int64_t now_ns, std::size_t joint,
                                        const CanFrame& frame) noexcept;
  void take_channels(std::int64_t now_ns, const CanFrame& frame) noexcept;
  [[nodiscard]] DriverState state_of(std::size_t joint) noexcept;
  void set_motion(std::int64_t now_ns, std::size_t joint) noexcept;
  [[nodiscard]] bool count_missed(std::size_t joint) noexcept;
  void take_feed() noexcept;
  void take_torso_encoder(std::int64_t now_ns, const CanFrame& frame) noexcept;
  void set_torso_pitch(std::int64_t time_ns, double angle_rad, double speed_rad_s) noexcept;

  [[nodiscard]] bool has_no_feedback(std::size_t joint) const noexcept;
  [[nodiscard]] DriverCommand at_shaft(std::size_t joint, const JointCommand& command) const noexcept;
  [[nodiscard]] JointBusStatus send(const std::array<CanFrame, kJoints>& frames) noexcept;
  void ask_drivers() noexcept;
  [[nodiscard]] JointBusStatus bus_status() const noexcept;

  RobotWiring wiring_;
  std::array<FrameBus*, kMaximumBuses> buses_{};
  std::size_t bus_count_ = 0;
  JointValues turn_offset_rad_{};
  std::array<DriverReading, kJoints> shafts_;
  JointReadings readings_;
  std::array<bool, kJoints> fresh_{};
  std::array<bool, kJoints> was_idle_{};               ///< in a frame of this read
  std::array<bool, kJoints> started_{};                ///< in this read
  std::array<std::uint32_t, kJoints> silent_reads_{};  ///< in a row
  std::array<std::uint32_t, kMaximumBuses> unsent_{};  ///< writes in a row of which nothing left for the bus
  bool wrote_ = false;                                 ///< since the newest read
  TorsoMeasurement torso_;
  bool pitch_is_channel_ = true;
  std::optional<canopen::EncoderReader> encoder_;
  TorsoFeed* feed_ = nullptr;
  TorsoSample sample_;  ///< newest that was taken
  bool has_emergency_stop_ = false;
  bool emergency_stop_released_ = false;
  std::int64_t emergency_stop_time_ns_ = 0;
  std::uint64_t writes_ = 0;
  std::array<CanFrame, kMaximumBatch> received_;
};

}  // namespace stilt::hal
