#pragma once

#include <cstdint>
#include <memory>
#include <random>

#include "mpc_core/control/estimator.h"
#include "mpc_core/control/plan.h"
#include "mpc_core/model/robot.h"
#include "tests/mpc_core/printers.h"

/// A plan made by hand: two contact phases with a switch between them.
namespace stilt::testing_support {

inline constexpr double kSwitch_s = 1.03;
inline constexpr double kPlanStart_s = 1.0;
inline constexpr double kPlanEnd_s = 1.06;
/// First node after the switch; the one before has the same time.
inline constexpr int kAfterSwitch = 3;

/// Walking-like state: knees bent, hip at 0.8 m, everything moving.
inline model::StateVector random_state(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  model::StateVector state = model::StateVector::NullaryExpr([&] { return 0.2 * unit(random); });
  state[1] += 0.8;
  state[4] += 0.5;
  state[6] += 0.5;
  state.tail<model::kPositions>() *= 5.0;
  return state;
}

/// Joint accelerations up to 10 rad/s^2, contact forces up to 200 N.
inline model::InputVector random_input(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  model::InputVector input;
  for (int i = 0; i < model::kInputs; ++i) input[i] = (i < model::kJoints ? 10.0 : 200.0) * unit(random);
  return input;
}

/// Nodes at 1, 1.015, 1.03 | 1.03, 1.045, 1.06 s: left stance, then right stance. Random states, inputs and
/// gains; as in a plan of the planner the last input repeats the one before.
inline std::unique_ptr<control::Plan> sample_plan(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  auto plan = std::make_unique<control::Plan>();
  plan->sequence = 0;
  plan->nodes = 6;
  plan->start_time_s = kPlanStart_s;
  const double times_s[] = {kPlanStart_s, 1.015, kSwitch_s, kSwitch_s, 1.045, kPlanEnd_s};
  for (int k = 0; k < plan->nodes; ++k) {
    control::PlanNode& node = plan->node[static_cast<std::size_t>(k)];
    node.time_s = times_s[k];
    node.state = random_state(random);
    node.input = random_input(random);
    node.gain = control::FeedbackGain::NullaryExpr([&] { return unit(random); });
    // The node before the switch starts the transition, whose mode is the one after it.
    node.mode = {k < kAfterSwitch - 1, k >= kAfterSwitch - 1};
  }
  plan->node[5].input = plan->node[4].input;
  return plan;
}

/// Sensors that show a state exactly.
inline control::SensorReading reading_of(const model::StateVector& state, double time_s) {
  control::SensorReading reading;
  reading.time_s = time_s;
  reading.joint_position_rad = state.segment<model::kJoints>(model::kFirstJoint);
  reading.joint_velocity_rad_s = state.tail<model::kJoints>();
  reading.base_pitch_rad = state[model::kFirstAngle];
  reading.base_pitch_rate_rad_s = state[model::kPositions + model::kFirstAngle];
  return reading;
}

}  // namespace stilt::testing_support
