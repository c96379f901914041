#pragma once

#include <array>
#include <vector>

#include "hal/robot/robot.h"
#include "host_tools/simulation/closed_loop/fault_plan.h"
#include "host_tools/simulation/plant/plant.h"

namespace stilt::simulation {

/// The plant behind the interface of the robot, with ideal motor drivers and sensors without buses. Readings
/// are those of the tick, or delayed by the plant's option. A driver evaluates the law of its command at each
/// time step of the plant.
class PlantRobot final : public hal::Robot {
 public:
  /// @param plant   must outlive this object
  /// @param faults  faults without buses, see needs_bus(); times in seconds from the start of the run
  PlantRobot(Plant& plant, std::vector<TimedFault> faults, double tick_s);

  /// Call after each tick of the control loop. Faults begin and end with the time steps that follow.
  void set_time(double time_s);

  /// Call before each time step of the plant: applies the drivers' torques.
  void drive();

  void read(std::int64_t now_ns, hal::RobotReadings& readings) noexcept override;
  [[nodiscard]] hal::JointBusStatus write(const hal::JointCommands& commands) noexcept override;
  [[nodiscard]] hal::JointBusStatus disable() noexcept override;
  void begin_bring_up() noexcept override {}
  [[nodiscard]] hal::BringUpProgress bring_up(std::int64_t now_ns) noexcept override;
  void restore_buses() noexcept override {}

 private:
  [[nodiscard]] bool active(FaultKind kind) const noexcept;
  [[nodiscard]] bool active(FaultKind kind, std::size_t joint) const noexcept;
  /// What the sensors gave last, before the delay of the readings.
  [[nodiscard]] const control::SensorReading& newest() const noexcept;
  void sense();
  void read_joint(std::size_t joint, std::int64_t now_ns, const control::SensorReading& sensors,
                  hal::JointReading& reading) const noexcept;
  void read_base(std::int64_t now_ns, const control::SensorReading& sensors,
                 hal::BaseReading& reading) const noexcept;

  Plant& plant_;
  std::vector<TimedFault> faults_;
  double time_s_ = 0.0;
  hal::JointCommands commands_{};
  /// Readings of the newest ticks in a ring; sensed_[next_] is the oldest.
  std::vector<control::SensorReading> sensed_;
  std::size_t next_ = 0;
  bool sensing_ = false;
  std::array<bool, hal::kJoints> enabled_;
};

}  // namespace stilt::simulation
