#pragma once

#include <memory>

#include "firmware/control_loop/planner_schedule.h"
#include "mpc_core/control/estimator.h"
#include "mpc_core/control/planner.h"
#include "mpc_core/control/torque_law.h"
#include "tests/host_tools/simulation/robot_on_bus/driven_robot.h"

namespace stilt::robot_on_bus::testing_support {

/// The predictive controller on the hardware abstraction, as small as it can be. Stands up with a torque that
/// grows over half a second, plans on the schedule of the simulation.
class MpcDriver {
 public:
  explicit MpcDriver(DrivenRobot& robot);

  /// One tick with this command to the planner.
  void tick(const gait::GaitCommand& command);

 private:
  [[nodiscard]] control::SensorReading reading() const;
  [[nodiscard]] double time_s() const { return 1e-9 * static_cast<double>(ticks_ * timing_.tick_ns); }

  DrivenRobot& robot_;
  control_loop::PlanTiming timing_;
  std::unique_ptr<control::Planner> planner_ = std::make_unique<control::Planner>();
  control::Estimator estimator_;
  control::TorqueLaw law_;
  std::unique_ptr<control::Plan> active_ = std::make_unique<control::Plan>();
  std::unique_ptr<control::Plan> next_ = std::make_unique<control::Plan>();
  long long ticks_ = 0;
  long long next_at_ = -1;
};

}  // namespace stilt::robot_on_bus::testing_support
