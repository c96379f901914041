#include "host_tools/experiments/random_robot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "host_tools/experiments/correlation.h"
#include "host_tools/simulation/plant/number.h"
#include "host_tools/simulation/plant/plant_options.h"

namespace stilt::experiments {
namespace {

constexpr double kNominalTorso_m = 0.21483, kOtherTorso_m = 0.28507;

std::vector<RandomQuantity> quantities() {
  return random_quantities(std::pair(kNominalTorso_m, kOtherTorso_m));
}

const RandomQuantity& named(const std::vector<RandomQuantity>& all, const std::string& name) {
  return *std::ranges::find(all, name, &RandomQuantity::name);
}

WalkCase walk_with(const std::string& name, double value) {
  const auto all = quantities();
  std::vector<double> values;
  for (const RandomQuantity& one : all)
    values.push_back(one.name == name ? value : one.nominal.value_or(one.low));
  WalkCase walk;
  apply_values(all, values, {}, walk);
  return walk;
}

simulation::PlantOptions world_of(const WalkCase& walk) {
  simulation::PlantOptions world;
  for (const std::string& assignment : walk.plant) simulation::set_plant_option(world, assignment);
  return world;
}

TEST(RandomRobot, EveryQuantityFillsItsRangeAndNeverLeavesIt) {
  const auto all = quantities();
  std::vector<double> smallest(all.size(), 1e9), largest(all.size(), -1e9);
  constexpr int kRobots = 2000;
  for (int run = 0; run < kRobots; ++run) {
    const std::vector<double> values = drawn_values(all, robot_seed(7, run));
    ASSERT_EQ(values.size(), all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      smallest[i] = std::min(smallest[i], values[i]);
      largest[i] = std::max(largest[i], values[i]);
    }
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double width = all[i].high - all[i].low;
    EXPECT_GE(smallest[i], all[i].low) << all[i].name;
    EXPECT_LT(smallest[i], all[i].low + 0.01 * width) << all[i].name;
    EXPECT_LE(largest[i], all[i].high) << all[i].name;
    EXPECT_GT(largest[i], all[i].high - 0.01 * width) << all[i].name;
  }
}

TEST(RandomRobot, RangesAreThoseOfTheExperiment) {
  const auto all = quantities();
  for (const char* link : {"torso", "thigh_L", "shin_L", "thigh_R", "shin_R"}) {
    for (const char* quantity : {"_mass_scale", "_inertia_scale"}) {
      EXPECT_EQ(named(all, std::string(link) + quantity).low, 0.85) << link;
      EXPECT_EQ(named(all, std::string(link) + quantity).high, 1.15) << link;
    }
    for (const char* quantity : {"_com_x_m", "_com_z_m"}) {
      EXPECT_EQ(named(all, std::string(link) + quantity).low, -0.02) << link;
      EXPECT_EQ(named(all, std::string(link) + quantity).high, 0.02) << link;
    }
  }
  struct Range {
    const char* name;
    double low, high;
  };
  for (const Range& range :
       {Range{"armature_scale", 0.75, 1.25}, Range{"joint_friction_Nm", 0.0, 5.0},
        Range{"plan_delay_s", 0.0, 0.006}, Range{"sensor_noise_scale", 0.0, 3.0}, Range{"friction", 0.4, 0.8},
        Range{"step_height_m", -0.02, 0.02}, Range{"ground_slope_rad", -0.05, 0.05},
        Range{"torque_limit_scale", 0.8, 1.0}, Range{"torso_com_m", kNominalTorso_m, kOtherTorso_m}}) {
    EXPECT_EQ(named(all, range.name).low, range.low) << range.name;
    EXPECT_EQ(named(all, range.name).high, range.high) << range.name;
  }
}

TEST(RandomRobot, OneOfTwoIsOneOfTheTwoAboutHalfOfTheTime) {
  const auto all = quantities();
  const auto torso =
      static_cast<std::size_t>(std::ranges::find(all, "torso_com_m", &RandomQuantity::name) - all.begin());
  int nominal = 0;
  constexpr int kRobots = 1000;
  for (int run = 0; run < kRobots; ++run) {
    const double height_m = drawn_values(all, robot_seed(3, run))[torso];
    EXPECT_TRUE(height_m == kNominalTorso_m || height_m == kOtherTorso_m) << height_m;
    nominal += height_m == kNominalTorso_m ? 1 : 0;
  }
  EXPECT_NEAR(nominal, 500, 4.0 * std::sqrt(250.0));
  EXPECT_EQ(random_quantities(std::nullopt).size(), all.size() - 1) << "another robot has one torso";
}

TEST(RandomRobot, ItsValuesDependOnItsSeedAlone) {
  const auto all = quantities();
  const std::vector<double> alone = drawn_values(all, robot_seed(1, 321));
  for (int run = 0; run < 321; ++run) (void)drawn_values(all, robot_seed(1, run));
  EXPECT_EQ(drawn_values(all, robot_seed(1, 321)), alone);
}

TEST(RandomRobot, SeedsOfTheRunsOfSeveralExperimentsDiffer) {
  std::set<std::uint32_t> seeds;
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    for (int run = 0; run < 100; ++run) seeds.insert(robot_seed(seed, run));
  }
  EXPECT_EQ(seeds.size(), 1000u);
}

TEST(RandomRobot, QuantitiesAreDrawnIndependentlyOfEachOther) {
  const auto all = quantities();
  constexpr int kRobots = 400;
  std::vector<std::vector<double>> columns(all.size());
  for (int run = 0; run < kRobots; ++run) {
    const std::vector<double> values = drawn_values(all, robot_seed(11, run));
    for (std::size_t i = 0; i < values.size(); ++i) columns[i].push_back(values[i]);
  }
  double largest = 0.0;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (std::size_t j = i + 1; j < columns.size(); ++j) {
      largest = std::max(largest, std::abs(correlation(columns[i], columns[j])->value));
    }
  }
  // The largest of about 530 correlations of 400 pairs: 4.5 standard errors are exceeded once in 300 seeds.
  EXPECT_LT(largest, 4.5 / std::sqrt(kRobots - 3.0));
}

TEST(RandomRobot, EveryValueReachesTheWalkUnchanged) {
  const auto all = quantities();
  const std::vector<double> values = drawn_values(all, robot_seed(5, 0));
  WalkCase walk;
  apply_values(all, values, {}, walk);
  const simulation::PlantOptions world = world_of(walk);
  const auto value = [&](const std::string& name) {
    return values[static_cast<std::size_t>(std::ranges::find(all, name, &RandomQuantity::name) -
                                           all.begin())];
  };
  EXPECT_EQ(world.links[0].mass_scale, value("torso_mass_scale"));
  EXPECT_EQ(world.links[1].inertia_scale, value("thigh_L_inertia_scale"));
  EXPECT_EQ(world.links[2].com_x_m, value("shin_L_com_x_m"));
  EXPECT_EQ(world.links[3].com_z_m, value("thigh_R_com_z_m"));
  EXPECT_EQ(world.links[4].mass_scale, value("shin_R_mass_scale"));
  EXPECT_EQ(world.torso_com_m, value("torso_com_m"));
  EXPECT_EQ(world.armature_scale, value("armature_scale"));
  EXPECT_EQ(world.joint_friction_Nm, value("joint_friction_Nm"));
  EXPECT_EQ(world.torque_limit_scale, value("torque_limit_scale"));
  EXPECT_EQ(world.base_pitch_bias_rad, value("base_pitch_bias_rad"));
  EXPECT_EQ(world.base_pitch_rate_bias_rad_s, value("base_pitch_rate_bias_rad_s"));
  EXPECT_EQ(world.friction, value("friction"));
  EXPECT_EQ(world.ground_slope_rad, value("ground_slope_rad"));
  EXPECT_EQ(world.step_height_m, value("step_height_m"));
  EXPECT_EQ(world.step_position_m, value("step_position_m"));
  EXPECT_EQ(walk.sensor_noise_scale, value("sensor_noise_scale"));
  EXPECT_EQ(walk.settings, std::vector<std::string>{"timing.plan_delay_s=" +
                                                    simulation::number_text(value("plan_delay_s"))});
}

TEST(RandomRobot, ThePushBeginsAtItsPhaseAndLeavesTimeToRecover) {
  for (const double phase : {0.0, 0.25, 1.999}) {
    const WalkCase walk = walk_with("push_phase", phase);
    EXPECT_NEAR(walk.push_start_s, 4.2 + 0.3 * phase, 1e-12);
    EXPECT_GE(walk.duration_s - walk.push_start_s - walk.push_duration_s, 4.5);
    EXPECT_EQ(walk.duration_s, walk_with("push_phase", 0.0).duration_s) << "no run is longer than another";
  }
}

}  // namespace
}  // namespace stilt::experiments
