#pragma once

#include <memory>

#include "host_tools/simulator/closed_loop.h"
#include "host_tools/simulator/mpc_controller.h"
#include "tests/host_tools/robot_on_bus/driven_robot.h"

namespace stilt::robot_on_bus::testing_support {

/// The predictive controller on the hardware abstraction, as small as it can be: stands up with a torque that
/// grows over half a second, plans on the schedule of the simulation.
class MpcDriver {
 public:
  explicit MpcDriver(DrivenRobot& robot);

  /// One tick with this command to the planner.
  void tick(const gait::GaitCommand& command);

 private:
  [[nodiscard]] control::SensorReading reading() const;
  [[nodiscard]] double time_s() const { return static_cast<double>(ticks_) * schedule_.tick_s; }

  DrivenRobot& robot_;
  std::unique_ptr<simulator::MpcController> controller_ = std::make_unique<simulator::MpcController>();
  simulator::TickSchedule schedule_;
  long long ticks_ = 0;
  long long adopt_at_ = 0;
};

}  // namespace stilt::robot_on_bus::testing_support
