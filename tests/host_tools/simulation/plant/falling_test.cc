#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "tests/host_tools/simulation/plant/test_robots.h"

namespace stilt::simulation {
namespace {

constexpr int kFalls = 80;
constexpr std::uint64_t kSeed = 7;
constexpr double kLongest_s = 2.0;
constexpr double kThigh_m = kAmberLeg.thigh_m;

using JointLaw = std::function<model::JointVector(double time_s, const model::StateVector& state)>;

/// As the supervisor's `damp`.
model::JointVector damp(double /*time_s*/, const model::StateVector& state) {
  return (-4.5 * state.tail<4>()).cwiseMin(40.0).cwiseMax(-40.0);
}

/// Draws the legs up for 0.2 s with the supervisor's gains of holding, towards its sitting pose, then damps.
model::JointVector tuck(double time_s, const model::StateVector& state) {
  if (time_s > 0.2) return damp(time_s, state);
  const model::JointVector sitting(-1.1, 2.2, -1.1, 2.2);
  const model::JointVector torque_Nm = 100.0 * (sitting - state.segment<4>(3)) - 4.5 * state.tail<4>();
  return torque_Nm.cwiseMin(80.0).cwiseMax(-80.0);
}

/// A robot that tumbles over one foot on the ground.
model::StateVector falling_state(std::mt19937_64& random, Plant& plant) {
  const auto between = [&random](double low, double high) {
    return low + (high - low) * std::generate_canonical<double, 53>(random);
  };
  model::StateVector state = model::StateVector::Zero();
  state[2] = between(-0.9, 0.9);
  for (int leg = 0; leg < 2; ++leg) {
    state[3 + 2 * leg] = between(-0.9, 0.5);
    state[4 + 2 * leg] = between(0.1, 1.0);
    state[10 + 2 * leg] = between(-3.0, 3.0);
    state[11 + 2 * leg] = between(-3.0, 3.0);
  }
  state[7] = between(-1.5, 1.5);
  state[8] = between(-1.0, 0.2);
  state[9] = between(-2.0, 2.0);
  plant.set_state(state);
  state[1] = -std::min(plant.foot_position_m()[1], plant.foot_position_m()[3]);
  return state;
}

/// Speed at which a knee or the torso's centre of mass meets the ground first.
double speed_at_ground_m_s(Plant& plant, const model::StateVector& start, const JointLaw& law) {
  plant.set_state(start);
  const auto heights_m = [&plant] {
    const model::StateVector state = plant.state();
    return std::array{state[1] - kThigh_m * std::cos(state[2] + state[3]),
                      state[1] - kThigh_m * std::cos(state[2] + state[5]), plant.torso_com_m().y()};
  };
  auto before_m = heights_m();
  for (double time_s = 0.0; time_s < kLongest_s; time_s += plant.time_step_s()) {
    plant.command_torque(law(time_s, plant.state()));
    plant.step();
    const auto now_m = heights_m();
    for (std::size_t part = 0; part < now_m.size(); ++part) {
      if (now_m[part] < 0.0) return (before_m[part] - now_m[part]) / plant.time_step_s();
    }
    before_m = now_m;
  }
  return 0.0;
}

double median_speed_m_s(const JointLaw& law) {
  std::mt19937_64 random(kSeed);
  Plant plant = amber_plant();
  std::vector<double> speeds_m_s;
  for (int fall = 0; fall < kFalls; ++fall) {
    const model::StateVector start = falling_state(random, plant);
    speeds_m_s.push_back(speed_at_ground_m_s(plant, start, law));
  }
  std::ranges::nth_element(speeds_m_s, speeds_m_s.begin() + kFalls / 2);
  return speeds_m_s[kFalls / 2];
}

/// Legs that are drawn up carry nothing: why a falling robot is damped at once (docs/hazards.md).
TEST(Falling, ADampedRobotMeetsTheGroundSlowerThanATuckedOne) {
  SCOPED_TRACE(kSeed);
  const double damped_m_s = median_speed_m_s(damp), tucked_m_s = median_speed_m_s(tuck);
  RecordProperty("damped_m_s", std::to_string(damped_m_s));
  RecordProperty("tucked_m_s", std::to_string(tucked_m_s));
  EXPECT_LT(damped_m_s, 0.9 * tucked_m_s) << damped_m_s << " m/s, tucked " << tucked_m_s;
}

}  // namespace
}  // namespace stilt::simulation
