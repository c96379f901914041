#pragma once

#include <cstddef>

#include "host_tools/simulator/controller.h"

namespace stilt::testing_support {

/// Passes every call on; tests override what they disturb or watch.
class ForwardingController : public simulator::Controller {
 public:
  explicit ForwardingController(simulator::Controller& inner) : inner_(inner) {}

  void reset(const model::StateVector& state, double time_s) override { inner_.reset(state, time_s); }
  simulator::TickOutput tick(const control::SensorReading& reading,
                             const model::StateVector* truth) override {
    return inner_.tick(reading, truth);
  }
  std::optional<solver::SolveReport> plan(double time_s, const gait::GaitCommand& command) override {
    return inner_.plan(time_s, command);
  }
  void adopt_plan() override { inner_.adopt_plan(); }
  [[nodiscard]] const control::Plan& newest_plan() const override { return inner_.newest_plan(); }
  [[nodiscard]] const control::Plan& plan_in_use() const override { return inner_.plan_in_use(); }
  [[nodiscard]] std::size_t bytes() const override { return inner_.bytes(); }

 private:
  simulator::Controller& inner_;
};

}  // namespace stilt::testing_support
