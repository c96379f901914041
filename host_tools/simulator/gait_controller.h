#pragma once

#include <memory>

#include "host_tools/simulator/mpc_controller.h"
#include "mpc_core/control/gait_tracker.h"

namespace stilt::simulator {

/// A gait tracked by the joints, without planning (hzd-pd). A gait has no beginning: the predictive
/// controller around the same gaits takes the first steps, and hands over at the first scheduled touch-down
/// after `hand_over_s` while a step or walk is commanded. Standing again is not in it.
class GaitController final : public Controller {
 public:
  /// Takes a configured predictive controller. The library has at least one gait.
  GaitController(const model::RobotModel& robot, const control::ControllerParameters& parameters,
                 std::unique_ptr<MpcController> starter, std::shared_ptr<const gait::GaitLibrary> library,
                 double hand_over_s);

  void reset(const model::StateVector& state, double time_s) override;
  TickOutput tick(const control::SensorReading& reading, const model::StateVector* true_state) override;
  std::optional<solver::SolveReport> plan(double time_s, const gait::GaitCommand& command) override;
  void adopt_plan() override;
  [[nodiscard]] const control::Plan& newest_plan() const override {
    return tracking_ ? none_ : starter_->newest_plan();
  }
  [[nodiscard]] const control::Plan& plan_in_use() const override {
    return tracking_ ? none_ : starter_->plan_in_use();
  }
  [[nodiscard]] std::size_t bytes() const override {
    return sizeof *this + starter_->bytes() + sizeof *library_;
  }

 private:
  [[nodiscard]] double speed_m_s() const {
    return command_.kind == gait::GaitKind::walk ? command_.speed_m_s : 0.0;
  }
  /// Begins to track when the plan has just put another foot down.
  void hand_over(const control::SensorReading& reading, const model::StateVector& state);

  const model::RobotModel& robot_;
  std::unique_ptr<MpcController> starter_;
  std::shared_ptr<const gait::GaitLibrary> library_;
  double hand_over_s_;
  control::GaitTracker tracker_;
  gait::GaitCommand command_;
  model::ContactMode mode_{true, true};
  bool tracking_ = false;
  control::Plan none_;
};

}  // namespace stilt::simulator
