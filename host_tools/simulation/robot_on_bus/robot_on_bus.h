#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "hal/can/frame.h"
#include "hal/canopen/encoder_emulator.h"
#include "hal/robot/robot_wiring.h"
#include "host_tools/simulation/closed_loop/fault_plan.h"
#include "host_tools/simulation/closed_loop/scenario.h"
#include "host_tools/simulation/plant/plant.h"
#include "host_tools/simulation/robot_on_bus/frame_line.h"
#include "host_tools/simulation/robot_on_bus/gantry.h"
#include "host_tools/simulation/robot_on_bus/hands.h"
#include "host_tools/simulation/robot_on_bus/joint_drivers.h"
#include "host_tools/simulation/robot_on_bus/torso_sensor_frames.h"
#include "host_tools/simulation/robot_on_bus/walk_recorder.h"

namespace stilt::robot_on_bus {

/// All settings of one simulated robot.
struct RobotSetup {
  hal::RobotWiring wiring;  ///< valid for bus_count
  std::size_t bus_count = 1;
  simulation::PlantModel model;
  simulation::PlantOptions plant;
  std::uint64_t seed = 1;
  model::StateVector standing = model::StateVector::Zero();  ///< starting pose, feet on the ground
  double tick_s = 0.001;
  double torso_sensor_rate_hz = 1000.0;  ///< frames per second of the torso sensor, at most one per tick
  GantryParameters gantry;
  JointMistakes mistakes{};
  double torso_sensor_delay_s = 0.0;  ///< of all its channels
  std::vector<simulation::TimedFault> faults;
  std::vector<simulation::Push> pushes;
  bool keep_samples = false;
};

/// A fault that has occurred.
struct InjectedFault {
  std::string name;
  double time_s = 0.0;  ///< since power-on of the robot
};

/// MuJoCo behind emulated motor drivers and an emulated torso sensor, connected by CAN frames. Uses neither
/// sockets nor clocks; equal calls give equal frames, bit for bit.
///
/// A command becomes active when its frame is received. At each time step of the plant the driver's law is
/// evaluated at the joint's present position and velocity, with the plant's encoder noise. Driver and plant
/// limit the torque. Replies contain the state of the newest time step. The torso sensor sends at the end of
/// a tick, at its own rate.
class RobotOnBus {
 public:
  /// Throws std::runtime_error when the plant refuses the model.
  explicit RobotOnBus(const RobotSetup& setup);

  /// Receives a frame of the controller.
  void receive(std::int64_t now_ns, std::size_t bus, const hal::CanFrame& frame);

  /// Advances by one time step of the plant. After the last one of a tick the drivers' timers run, and the
  /// torso sensor sends.
  void step(std::int64_t now_ns);

  /// Advances by a whole tick.
  void tick(std::int64_t now_ns);

  /// What people do to the robot with their hands.
  [[nodiscard]] Hands& hands() { return hands_; }

  /// Takes the frames that the robot's nodes have sent on a bus by now.
  [[nodiscard]] std::vector<hal::CanFrame> take_outgoing(std::int64_t now_ns, std::size_t bus);

  /// Takes the bytes that a torso sensor on a serial port has sent by now.
  [[nodiscard]] std::vector<std::uint8_t> take_serial();

  /// Whether a fault has disconnected the bus.
  [[nodiscard]] bool disconnected(std::size_t bus) const { return bus_gone_[bus]; }

  [[nodiscard]] std::uint64_t ticks() const { return ticks_; }
  [[nodiscard]] int steps_per_tick() const { return steps_per_tick_; }
  [[nodiscard]] double time_step_s() const { return plant_.time_step_s(); }
  /// Time since power-on of the robot.
  [[nodiscard]] double time_s() const { return static_cast<double>(ticks_) * setup_.tick_s; }
  /// Time since the first release by the gantry; nothing before.
  [[nodiscard]] std::optional<double> walk_time_s() const;
  /// Time of the first release by the gantry, since power-on of the robot.
  [[nodiscard]] std::optional<double> gantry_released_s() const;

  /// Time since the release by the gantry at which the robot had sat down in order and the gantry took its
  /// weight.
  [[nodiscard]] std::optional<double> sat_down_s() const { return sat_down_s_; }

  [[nodiscard]] const simulation::Plant& plant() const { return plant_; }
  [[nodiscard]] const JointDrivers& drivers() const { return drivers_; }
  [[nodiscard]] JointDrivers& drivers() { return drivers_; }
  [[nodiscard]] const Gantry& gantry() const { return gantry_; }
  [[nodiscard]] const WalkRecorder& recorder() const { return recorder_; }
  [[nodiscard]] const std::vector<InjectedFault>& injected_faults() const { return injected_; }

  /// Ends the run: completes the statistics.
  void finish();

 private:
  void inject_faults(std::int64_t now_ns);
  void begin_fault(std::int64_t now_ns, const simulation::TimedFault& fault);
  void end_fault(std::int64_t now_ns, const simulation::TimedFault& fault);
  void lower_supply(const simulation::TimedFault& fault);
  void set_bus_off(std::int64_t now_ns, std::size_t bus, bool off);
  [[nodiscard]] bool active(simulation::FaultKind kind) const;
  void read_encoders();
  void act();
  void finish_tick(std::int64_t now_ns);
  void run_timers(std::int64_t now_ns);
  void send_base(std::int64_t now_ns);
  void send_serial(const BaseValues& values);
  void send_from_driver(std::int64_t now_ns, std::size_t joint, const hal::FrameSink& frames);
  void send_from_torso(std::int64_t now_ns, std::size_t bus, const hal::FrameSink& frames);
  void set_torso_encoder(double pitch_rad, double pitch_rate_rad_s);
  [[nodiscard]] bool base_due();
  [[nodiscard]] BaseValues base_values();
  void update_rig();
  void end_walk(simulation::Fall fall);
  [[nodiscard]] bool sits_down() const;
  [[nodiscard]] bool torque_on() const;
  /// Time since the release by the gantry; negative before.
  [[nodiscard]] double clock_s() const { return walk_time_s().value_or(-1.0); }
  template <class Action>
  void for_each_driver(const simulation::TimedFault& fault, Action&& action);

  RobotSetup setup_;
  simulation::Plant plant_;
  int steps_per_tick_;
  JointDrivers drivers_;
  TorsoSensorFrames torso_sensor_;
  std::optional<hal::canopen::EncoderEmulator> torso_encoder_;
  std::vector<std::uint8_t> serial_bytes_;
  Gantry gantry_;
  Hands hands_;
  Hands obstacles_;  ///< what blocks joints
  FrameLine line_;
  WalkRecorder recorder_;
  std::uint64_t ticks_ = 0;
  std::uint64_t base_frames_ = 0;  ///< periods of the torso sensor that have ended
  int step_in_tick_ = 0;
  std::optional<std::uint64_t> release_tick_;
  int sitting_ticks_ = 0;  ///< consecutive
  std::optional<double> sat_down_s_;
  double fault_clock_s_ = -1.0;  ///< clock_s() at the beginning of the tick: faults begin and end with it
  std::vector<bool> fault_active_;
  std::vector<InjectedFault> injected_;
  std::array<bool, hal::kMaximumBuses> bus_off_{};
  std::array<bool, hal::kMaximumBuses> bus_gone_{};
  BaseValues base_values_{};
  std::deque<BaseValues> late_values_;  ///< of the ticks that the torso sensor is late by
  double base_velocity_m_s_[2] = {};
};

}  // namespace stilt::robot_on_bus
