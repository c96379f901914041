#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host_tools/simulation/plant/plant.h"
#include "tests/host_tools/simulation/plant/test_robots.h"

namespace stilt::simulation {
namespace {

using model::JointVector;
using model::StateVector;

TEST(PlantSensors, SensorsShowTheJointsAndThePitchAndNothingElse) {
  Plant plant = amber_plant();
  const StateVector state = tumbling();
  plant.set_state(state);
  const control::SensorReading reading = plant.read_sensors();
  EXPECT_EQ(reading.joint_position_rad, JointVector(state.segment<4>(3)));
  EXPECT_EQ(reading.joint_velocity_rad_s, JointVector(state.tail<4>()));
  EXPECT_EQ(reading.base_pitch_rad, state[2]);
  EXPECT_EQ(reading.base_pitch_rate_rad_s, state[9]);
}

TEST(PlantSensors, TheNoiseOfEachSensorHasItsStandardDeviationAndFollowsTheSeed) {
  PlantOptions options;
  options.encoder_noise_rad = 0.01;
  options.encoder_velocity_noise_rad_s = 0.3;
  options.base_pitch_noise_rad = 0.02;
  options.base_pitch_rate_noise_rad_s = 0.2;
  Plant plant = amber_plant(options, 3), same = amber_plant(options, 3), other = amber_plant(options, 4);
  for (Plant* each : {&plant, &same, &other}) each->set_state(tumbling());
  constexpr int kReadings = 20000;
  const StateVector state = tumbling();
  double angle = 0.0, speed = 0.0, pitch = 0.0, rate = 0.0;  // squares
  bool differs = false;
  for (int i = 0; i < kReadings; ++i) {
    const control::SensorReading noisy = plant.read_sensors();
    angle += (noisy.joint_position_rad - JointVector(state.segment<4>(3))).squaredNorm() / 4.0;
    speed += (noisy.joint_velocity_rad_s - JointVector(state.tail<4>())).squaredNorm() / 4.0;
    pitch += std::pow(noisy.base_pitch_rad - state[2], 2);
    rate += std::pow(noisy.base_pitch_rate_rad_s - state[9], 2);
    EXPECT_EQ(noisy.joint_position_rad, same.read_sensors().joint_position_rad);
    differs = differs || noisy.joint_position_rad != other.read_sensors().joint_position_rad;
  }
  EXPECT_NEAR(std::sqrt(angle / kReadings), 0.01, 1e-4);
  EXPECT_NEAR(std::sqrt(speed / kReadings), 0.3, 3e-3);
  EXPECT_NEAR(std::sqrt(pitch / kReadings), 0.02, 4e-4);
  EXPECT_NEAR(std::sqrt(rate / kReadings), 0.2, 4e-3);
  EXPECT_TRUE(differs);
}

TEST(PlantSensors, ABiasShiftsPitchAndRateOfTheTorsoAndNothingElse) {
  PlantOptions exact, biased;
  exact.encoder_noise_rad = exact.base_pitch_noise_rad = exact.base_pitch_rate_noise_rad_s = 0.01;
  biased = exact;
  biased.base_pitch_bias_rad = 0.02;
  biased.base_pitch_rate_bias_rad_s = -0.03;
  Plant exact_plant = amber_plant(exact), biased_plant = amber_plant(biased);
  exact_plant.set_state(tumbling());
  biased_plant.set_state(tumbling());
  for (int i = 0; i < 10; ++i) {
    const control::SensorReading expected = exact_plant.read_sensors(), reading = biased_plant.read_sensors();
    EXPECT_NEAR(reading.base_pitch_rad - expected.base_pitch_rad, 0.02, 1e-12);
    EXPECT_NEAR(reading.base_pitch_rate_rad_s - expected.base_pitch_rate_rad_s, -0.03, 1e-12);
    EXPECT_EQ(reading.joint_position_rad, expected.joint_position_rad);
    EXPECT_EQ(reading.joint_velocity_rad_s, expected.joint_velocity_rad_s);
  }
}

TEST(PlantSensors, QuantisedReadingsAreTheMultiplesNextToTheNoisyValues) {
  PlantOptions noisy;
  noisy.encoder_noise_rad = 0.01;
  noisy.encoder_velocity_noise_rad_s = 0.3;
  noisy.base_pitch_noise_rad = 0.02;
  noisy.base_pitch_rate_noise_rad_s = 0.2;
  PlantOptions quantised = noisy;
  quantised.encoder_resolution_rad = 2.0 * std::numbers::pi / 16384.0;
  quantised.encoder_velocity_resolution_rad_s = 0.01;
  Plant exact_plant = amber_plant(noisy), quantised_plant = amber_plant(quantised);
  exact_plant.set_state(tumbling());
  quantised_plant.set_state(tumbling());
  double squares[2] = {};
  const auto compare = [&squares](double exact, double reported, double resolution, double& sum) {
    EXPECT_NEAR(std::remainder(reported, resolution), 0.0, 1e-12);
    EXPECT_LE(std::abs(reported - exact), 0.5 * resolution + 1e-12);
    sum += (reported - exact) * (reported - exact);
  };
  constexpr int kReadings = 10000;
  for (int i = 0; i < kReadings; ++i) {
    const control::SensorReading exact = exact_plant.read_sensors(),
                                 reported = quantised_plant.read_sensors();
    for (int joint = 0; joint < model::kJoints; ++joint) {
      compare(exact.joint_position_rad[joint], reported.joint_position_rad[joint],
              quantised.encoder_resolution_rad, squares[0]);
      compare(exact.joint_velocity_rad_s[joint], reported.joint_velocity_rad_s[joint],
              quantised.encoder_velocity_resolution_rad_s, squares[1]);
    }
    compare(exact.base_pitch_rad, reported.base_pitch_rad, quantised.encoder_resolution_rad, squares[0]);
    compare(exact.base_pitch_rate_rad_s, reported.base_pitch_rate_rad_s,
            quantised.encoder_velocity_resolution_rad_s, squares[1]);
  }
  // The error of a quantiser is uniform: its root mean square is the resolution over the root of 12.
  const double root_12 = std::sqrt(12.0);
  EXPECT_NEAR(std::sqrt(squares[0] / (5 * kReadings)) * root_12, quantised.encoder_resolution_rad,
              0.01 * quantised.encoder_resolution_rad);
  EXPECT_NEAR(std::sqrt(squares[1] / (5 * kReadings)) * root_12, quantised.encoder_velocity_resolution_rad_s,
              0.01 * quantised.encoder_velocity_resolution_rad_s);
}

}  // namespace
}  // namespace stilt::simulation
