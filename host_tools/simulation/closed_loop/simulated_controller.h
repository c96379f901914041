#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "firmware/control_loop/control_loop.h"
#include "firmware/control_loop/planner_schedule.h"
#include "firmware/control_loop/planner_task.h"
#include "hal/robot/clock.h"

namespace stilt::simulation {

/// Components of a controller in the simulation.
struct ControllerSetup {
  const model::RobotModel* robot = nullptr;
  const model::RobotModel* planning_model = nullptr;  ///< set when the planner uses another model
  control::ControllerParameters parameters;
  supervisor::SupervisorParameters supervision;
  std::shared_ptr<const gait::GaitLibrary> reference_gaits;  ///< gaits that the planner follows; null:
                                                             ///< heuristics
  std::shared_ptr<const gait::GaitLibrary> fallback_gaits;   ///< gaits tracked without plans; null: none
};

/// The controller of the robot on virtual time: its control loop, its planner, and the schedule between them.
/// It begins with the robot on its feet. Equal calls give equal results, bit for bit, except for the
/// durations of solves.
class SimulatedController {
 public:
  /// Configures the controller. Takes milliseconds. An automatic sqp.instruction_set is that of the build, so
  /// that a simulation gives the same on every processor.
  [[nodiscard]] control::ConfigureStatus configure(ControllerSetup setup);

  /// Restarts for a robot that stands, with a first plan for the command. Call before tick 0.
  /// @param known_state  replaces the estimate when it is not null, as in tick()
  /// @return  duration of the first solve by the wall clock, ns
  std::int64_t begin(hal::Robot& robot, const gait::GaitCommand& command,
                     const model::StateVector* known_state);

  /// Runs one tick of the control loop, after activating a plan that is due.
  const control_loop::TickRecord& tick(long long tick, const gait::GaitCommand& command,
                                       const model::StateVector* known_state);

  /// Runs the planner's turn after a tick.
  /// @return  duration of the solve by the wall clock, ns; nothing when it is not time to plan
  [[nodiscard]] std::optional<std::int64_t> plan(long long tick);

  /// The newest usable plan.
  [[nodiscard]] const control::Plan& newest_plan() const { return mail_->plans.writer(); }
  /// The plan that the control loop had in the newest tick; without nodes before the first tick.
  [[nodiscard]] const control::Plan& active_plan() const { return mail_->plans.newest(); }
  /// The planning request of the newest tick.
  [[nodiscard]] const control_loop::PlanningRequest& request() const { return mail_->requests.newest(); }
  /// The report of the newest solve.
  [[nodiscard]] const sqp::SolveReport& report() const { return planner_->report(); }
  [[nodiscard]] const control::ControllerParameters& parameters() const { return setup_.parameters; }
  [[nodiscard]] const control_loop::PlanTiming& timing() const { return schedule_.timing(); }
  [[nodiscard]] dispatch::DispatchedPlanner& planner() { return planner_->planner(); }

  /// Size of control loop, planner, and the plans between them, bytes.
  [[nodiscard]] static std::size_t bytes();

 private:
  void publish(const gait::GaitCommand& command);

  ControllerSetup setup_;
  std::unique_ptr<control_loop::PlannerTask> planner_ = std::make_unique<control_loop::PlannerTask>();
  std::unique_ptr<control_loop::Mailboxes> mail_;
  std::unique_ptr<control_loop::ControlLoop> loop_;
  control_loop::PlannerSchedule schedule_{control::TimingParameters{}};
  control_loop::OperatorCommand command_;
  control_loop::TickRecord record_;
  hal::MonotonicClock clock_;  ///< for the durations of solves
};

}  // namespace stilt::simulation
