#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <tuple>
#include <vector>

#include "tests/closed_loop/simulated_run.h"

/// Half a minute at 0.5 m/s with one thing changed: robot, planner, or the world, which is not in its model.
namespace stilt::simulation {
namespace {

using testing_support::describe;
using testing_support::RunRequest;
using testing_support::SimulatedRun;

constexpr double kSpeed_m_s = 0.5;
constexpr double kDuration_s = 30.0;

struct Variant {
  const char* name;
  const char* robot = "amber3m";
  const char* preset = "";
  std::vector<std::string> settings = {};
  std::vector<std::string> plant = {};
  std::uint64_t seed = 1;

  friend std::ostream& operator<<(std::ostream& stream, const Variant& variant) {
    return stream << variant.name;
  }
};

const std::vector<std::string> kSensorNoise = {"encoder_noise_rad=0.001", "encoder_velocity_noise_rad_s=0.05",
                                               "base_pitch_noise_rad=0.001",
                                               "base_pitch_rate_noise_rad_s=0.05"};

const std::vector<std::string> kEncodersOf14Bits = {"encoder_resolution_rad=0.000383495",
                                                    "encoder_velocity_resolution_rad_s=0.01"};

std::vector<Variant> variants() {
  return {
      {.name = "Rabbit", .robot = "rabbit"},
      {.name = "TorsoOf2020", .robot = "amber3m_2020"},
      {.name = "TorqueSpeedLine", .settings = {"robot.no_load_speed_rad_s=10"}},
      {.name = "PaperPreset", .preset = "paper"},
      {.name = "WithoutArmature", .settings = {"robot.armature_scale=0"}, .plant = {"armature=0"}},
      {.name = "RungeKutta4", .settings = {"discretisation.integrator=rk4"}},
      {.name = "IdentityAtTouchDown", .settings = {"discretisation.transition=identity"}},
      {.name = "ImpactMapAtTouchDown", .settings = {"discretisation.transition=impact"}},
      {.name = "DoubleSupport", .settings = {"gait.double_support_s=0.045"}},
      {.name = "FeedbackGainsOfEveryPlan",
       .settings = {"torque_law.feedback_from_age_s=0", "torque_law.feedback_full_age_s=0.001"}},
      {.name = "StepsOf400Milliseconds", .settings = {"gait.single_support_s=0.4"}},
      {.name = "OneIterationAPlan",
       .settings = {"sqp.iterations=1", "sqp.plan_defect_max=1e6", "sqp.plan_cone_violation_max_N=1e6",
                    "sqp.plan_pulling_force_max_N=1e6"}},
      {.name = "NoiseSeed1", .plant = kSensorNoise, .seed = 1},
      {.name = "NoiseSeed2", .plant = kSensorNoise, .seed = 2},
      {.name = "NoiseSeed3", .plant = kSensorNoise, .seed = 3},
      {.name = "FivePercentHeavier", .plant = {"mass_scale=1.05"}},
      {.name = "FivePercentLighter", .plant = {"mass_scale=0.95"}},
      {.name = "Uphill", .plant = {"ground_slope_rad=0.02"}},
      {.name = "Downhill", .plant = {"ground_slope_rad=-0.02"}},
      {.name = "AStepUp", .plant = {"step_height_m=0.01"}},
      {.name = "AStepDown", .plant = {"step_height_m=-0.01"}},
      {.name = "AStepUpOf7Centimetres", .plant = {"step_height_m=0.07"}},
      {.name = "AStepDownOf20Centimetres", .plant = {"step_height_m=-0.2"}},
      {.name = "AnnouncedFrictionOfTwoTenths",
       .settings = {"inequality.friction_coefficient=0.2"},
       .plant = {"friction=0.2"}},
      {.name = "TorqueTwoMillisecondsLate", .plant = {"delay_s=0.002"}},
      {.name = "MotorsThatEndAt5RadPerSecond", .plant = {"no_load_speed_rad_s=5"}},
      {.name = "DrivesWithALagOf5Milliseconds", .plant = {"drive_time_constant_s=0.005"}},
      {.name = "EncodersOf14Bits", .plant = kEncodersOf14Bits},
      {.name = "JointFrictionOf2Nm", .plant = {"joint_friction_Nm=2"}},
      {.name = "StifferContact", .plant = {"contact_time_constant_s=0.001"}},
      {.name = "SofterContact", .plant = {"contact_time_constant_s=0.016"}},
      {.name = "PhysicsStepOf100Microseconds", .plant = {"time_step_s=0.0001"}},
      {.name = "JointStops", .plant = {"joint_stops=1"}},
  };
}

class Variants : public ::testing::TestWithParam<std::tuple<Variant, double>> {};

TEST_P(Variants, Walks) {
  const auto& [variant, horizon_s] = GetParam();
  RunRequest request = testing_support::walking(kSpeed_m_s, horizon_s, kDuration_s);
  request.robot = variant.robot;
  request.preset = variant.preset;
  request.settings = variant.settings;
  request.plant = variant.plant;
  request.seed = variant.seed;
  SimulatedRun run(request);
  const log::RunRecord record = run.run();
  ASSERT_TRUE(record.summary.survived) << describe(run, record);
  EXPECT_NEAR(record.summary.mean_speed_m_s, kSpeed_m_s, 0.05) << describe(run, record);
}

INSTANTIATE_TEST_SUITE_P(ClosedLoop, Variants,
                         ::testing::Combine(::testing::ValuesIn(variants()), ::testing::Values(1.0, 2.0)),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param).name) + "Horizon" +
                                  std::to_string(static_cast<int>(std::get<1>(test.param)));
                         });

}  // namespace
}  // namespace stilt::simulation
