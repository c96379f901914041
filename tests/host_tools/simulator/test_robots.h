#pragma once

#include <cmath>

#include "host_tools/simulator/mpc_controller.h"
#include "host_tools/simulator/plant.h"
#include "host_tools/simulator/simulated_robot.h"
#include "host_tools/simulator/stance.h"
#include "mpc_core/model/robot.h"

/// Robots and controllers that several tests of the simulator use.
namespace stilt::simulator {

inline constexpr LegLengths kAmberLeg{0.4064, 0.4667};
inline constexpr double kHipHeight_m = 0.8;

inline Plant amber_plant(const PlantOptions& options = {}, std::uint64_t seed = 1) {
  return Plant(make_plant_model(simulated_robot("amber3m"), options, kHipHeight_m), options, seed);
}

/// In the air, every velocity different from zero.
inline model::StateVector tumbling() {
  model::StateVector state = standing_state(kAmberLeg, kHipHeight_m, 0.15);
  state[1] = 5.0;
  state.tail<7>() << 0.5, 1.0, 0.7, -1.0, 2.0, 1.5, -0.5;
  return state;
}

/// Steps with the joints held by a stiff spring and damper.
inline void hold(Plant& plant, const model::StateVector& posture, double duration_s) {
  for (int i = 0; i < std::lround(duration_s / plant.time_step_s()); ++i) {
    const model::StateVector state = plant.state();
    plant.command_torque(800.0 * (posture - state).segment<4>(3) - 40.0 * state.tail<4>());
    plant.step();
  }
}

/// Holds the joints where they were at reset.
class HoldingController final : public Controller {
 public:
  void reset(const model::StateVector& state, double) override { held_ = state; }
  TickOutput tick(const control::SensorReading& reading, const model::StateVector*) override {
    ++ticks;
    last_reading = reading;
    const model::JointVector error_rad =
        held_.segment<model::kJoints>(model::kFirstJoint) - reading.joint_position_rad;
    return {held_, 800.0 * error_rad - 40.0 * reading.joint_velocity_rad_s};
  }
  std::optional<solver::SolveReport> plan(double, const gait::GaitCommand&) override { return std::nullopt; }
  void adopt_plan() override {}
  [[nodiscard]] const control::Plan& newest_plan() const override { return no_plan_; }
  [[nodiscard]] const control::Plan& plan_in_use() const override { return no_plan_; }
  [[nodiscard]] std::size_t bytes() const override { return sizeof *this; }

  int ticks = 0;
  control::SensorReading last_reading;

 private:
  model::StateVector held_ = model::StateVector::Zero();
  control::Plan no_plan_;
};

}  // namespace stilt::simulator
