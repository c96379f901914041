#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "firmware/control_loop/control_loop.h"
#include "firmware/control_loop/planner_schedule.h"
#include "firmware/control_loop/planner_task.h"
#include "hal/robot/clock.h"

namespace stilt::simulation {

/// What makes a controller in the simulation.
struct ControllerSetup {
  const model::RobotModel* robot = nullptr;
  const model::RobotModel* planning_model = nullptr;  ///< when the planner uses another model
  control::ControllerParameters parameters;
  supervisor::SupervisorParameters supervision;
  std::shared_ptr<const gait::GaitLibrary> reference_gaits;  ///< followed by the planner; null: heuristics
  std::shared_ptr<const gait::GaitLibrary> fallback_gaits;   ///< tracked without plans; null: none
};

/// The controller of the robot on virtual time: its control loop, its planner, and the schedule between them.
/// Begins on its feet. Equal calls give equal results, bit for bit, but for the durations of solves.
class SimulatedController {
 public:
  /// Milliseconds.
  [[nodiscard]] control::ConfigureStatus configure(ControllerSetup setup);

  /// Starts over in front of a robot that stands, with a first plan for the command. Before tick 0.
  /// @param known_state  replaces the estimate when it is not null, as in tick()
  /// @return  duration of the first solve on the wall clock, ns
  std::int64_t begin(hal::Robot& robot, const gait::GaitCommand& command,
                     const model::StateVector* known_state);

  /// One tick of the control loop, after a plan that is due has become active.
  const control_loop::TickRecord& tick(long long tick, const gait::GaitCommand& command,
                                       const model::StateVector* known_state);

  /// The planner's turn after a tick.
  /// @return  duration of the solve on the wall clock, ns; nothing when it is not time to plan
  [[nodiscard]] std::optional<std::int64_t> plan(long long tick);

  /// The result of the newest solve, when it was usable.
  [[nodiscard]] const control::Plan& newest_plan() const { return mail_->plans.writer(); }
  /// The plan that the control loop had in the newest tick; without nodes before the first.
  [[nodiscard]] const control::Plan& active_plan() const { return mail_->plans.newest(); }
  /// Of the newest tick.
  [[nodiscard]] const control_loop::PlanningRequest& request() const { return mail_->requests.newest(); }
  /// Of the newest solve.
  [[nodiscard]] const sqp::SolveReport& report() const { return planner_->report(); }
  [[nodiscard]] const control_loop::PlanTiming& timing() const { return schedule_.timing(); }
  [[nodiscard]] control::Planner& planner() { return planner_->planner(); }

  /// Size of control loop, planner, and the plans between them.
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
