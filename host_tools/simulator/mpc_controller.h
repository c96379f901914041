#pragma once

#include <array>
#include <memory>
#include <utility>

#include "host_tools/simulator/controller.h"
#include "mpc_core/control/planner.h"
#include "mpc_core/control/torque_loop.h"

namespace stilt::simulator {

/// The predictive controller of mpc_core behind the simulation's interface: the very planner and torque loop
/// of the robot, with two plans of which one is in use. Large: to be placed on the heap or statically.
class MpcController final : public Controller {
 public:
  [[nodiscard]] control::ConfigureStatus configure(const model::RobotModel& robot,
                                                   const control::ControllerParameters& parameters) {
    return configure(robot, robot, parameters);
  }
  /// The planner believes in another model than the torque law and the estimator.
  [[nodiscard]] control::ConfigureStatus configure(const model::RobotModel& robot,
                                                   const model::RobotModel& planning_model,
                                                   const control::ControllerParameters& parameters);

  /// Steps follow the gaits of a library with at least one gait. Call after configure().
  void follow(std::shared_ptr<const gait::GaitLibrary> library) {
    planner_.follow(library.get());
    library_ = std::move(library);
  }

  void reset(const model::StateVector& state, double time_s) override;
  TickOutput tick(const control::SensorReading& reading, const model::StateVector* true_state) override;
  std::optional<solver::SolveReport> plan(double time_s, const gait::GaitCommand& command) override;
  void adopt_plan() override;
  [[nodiscard]] const control::Plan& newest_plan() const override { return plans_[newest_]; }
  [[nodiscard]] const control::Plan& plan_in_use() const override { return plans_[in_use_]; }
  [[nodiscard]] std::size_t bytes() const override { return sizeof *this; }

  [[nodiscard]] control::Planner& planner() { return planner_; }

 private:
  std::shared_ptr<const gait::GaitLibrary> library_;
  control::Planner planner_;
  control::TorqueLoop torque_loop_;
  std::array<control::Plan, 2> plans_;
  std::size_t in_use_ = 0;
  std::size_t newest_ = 0;
  model::StateVector state_ = model::StateVector::Zero();
};

}  // namespace stilt::simulator
