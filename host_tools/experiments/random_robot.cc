#include "host_tools/experiments/random_robot.h"

#include <array>
#include <cstddef>
#include <random>

#include "host_tools/experiments/disturbance.h"
#include "host_tools/experiments/portable_random.h"
#include "host_tools/experiments/table_text.h"
#include "host_tools/simulation/plant/number.h"

// Why these ranges: docs/results.md, "Random robots and worlds"
namespace stilt::experiments {
namespace {

constexpr double kStepsOfPhase = 2.0;  // the push begins in a step of either foot

void add_links(std::vector<RandomQuantity>& quantities) {
  struct Link {
    const char* key;
    const char* words;
  };
  constexpr Link kLinks[] = {{"torso", "torso"},
                             {"thigh_L", "left thigh"},
                             {"shin_L", "left shin"},
                             {"thigh_R", "right thigh"},
                             {"shin_R", "right shin"}};
  for (const Link& link : kLinks) {
    const std::string key = std::string(link.key) + "_";
    const std::string words = std::string(link.words) + ": ";
    quantities.push_back({key + "mass_scale", words + "mass, factor", "1", 0.85, 1.15, 1.0});
    quantities.push_back({key + "inertia_scale", words + "inertia, factor", "1", 0.85, 1.15, 1.0});
    quantities.push_back({key + "com_x_m", words + "centre of mass forward", "m", -0.02, 0.02, 0.0});
    quantities.push_back({key + "com_z_m", words + "centre of mass up", "m", -0.02, 0.02, 0.0});
  }
}

}  // namespace

std::vector<RandomQuantity> random_quantities(std::optional<std::pair<double, double>> torso_com_m) {
  std::vector<RandomQuantity> quantities;
  add_links(quantities);
  if (torso_com_m) {
    const auto [nominal_m, other_m] = *torso_com_m;
    quantities.push_back({"torso_com_m", "torso: centre of mass above the hip, one of two", "m", nominal_m,
                          other_m, nominal_m, Changes::plant, true});
  }
  const std::vector<RandomQuantity> rest = {
      {"armature_scale", "armature, factor", "1", 0.75, 1.25, 1.0},
      {"joint_friction_Nm", "Coulomb friction of the joints", "Nm", 0.0, 5.0, 0.0},
      {"torque_limit_scale", "torque limit, factor", "1", 0.8, 1.0, 1.0},
      {"plan_delay_s", "delay of the plan", "s", 0.0, 0.006, {}, Changes::plan_delay},
      {"sensor_noise_scale", "sensor noise, factor", "1", 0.0, 3.0, 1.0, Changes::sensor_noise},
      {"base_pitch_bias_rad", "torso sensor: mounting error and bias of the pitch", "rad", -0.026, 0.026,
       0.0},
      {"base_pitch_rate_bias_rad_s", "torso sensor: bias of the rate", "rad/s", -0.0087, 0.0087, 0.0},
      {"friction", "friction coefficient of the ground", "1", 0.4, 0.8, 0.6},
      {"ground_slope_rad", "slope of the ground", "rad", -0.05, 0.05, 0.0},
      {"step_height_m", "step of the ground: height", "m", -0.02, 0.02, 0.0},
      {"step_position_m", "step of the ground: place", "m", 0.5, 4.5, std::nullopt},
      {"push_phase", "start of the push, in steps", "1", 0.0, kStepsOfPhase, std::nullopt,
       Changes::push_phase},
  };
  quantities.insert(quantities.end(), rest.begin(), rest.end());
  return quantities;
}

std::vector<RandomQuantity> combined_quantities() {
  return {
      {"slope_as_read_rad", "slope of the ground as the torso sensor reads it", "rad", -0.076, 0.076, 0.0}};
}

std::string ranges_text(const std::vector<RandomQuantity>& quantities) {
  std::string all;
  for (const RandomQuantity& one : quantities) {
    all += one.name + " " + simulation::number_text(one.low) + " " + simulation::number_text(one.high) + "\n";
  }
  return all;
}

std::uint32_t robot_seed(std::uint32_t experiment_seed, int run) {
  std::seed_seq mixed{experiment_seed, static_cast<std::uint32_t>(run)};
  std::array<std::uint32_t, 1> seed;
  mixed.generate(seed.begin(), seed.end());
  return seed[0];
}

std::vector<double> drawn_values(const std::vector<RandomQuantity>& quantities, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<double> values;
  for (const RandomQuantity& one : quantities) {
    if (one.ends_only) {
      values.push_back(between(random, 0.0, 1.0) < 0.5 ? one.low : one.high);
    } else {
      values.push_back(std::stod(text("%.4g", between(random, one.low, one.high))));
    }
  }
  return values;
}

void apply_values(const std::vector<RandomQuantity>& quantities, const std::vector<double>& values,
                  const PushTiming& timing, WalkCase& walk) {
  walk.push_duration_s = timing.duration_s;
  walk.duration_s =
      lift_off_s(timing.settled_s, timing.step_time_s, kStepsOfPhase) + timing.duration_s + timing.recovery_s;
  for (std::size_t i = 0; i < quantities.size(); ++i) {
    switch (quantities[i].changes) {
      case Changes::plant:
        walk.plant.push_back(quantities[i].name + "=" + simulation::number_text(values[i]));
        break;
      case Changes::plan_delay:
        walk.settings.push_back("timing.plan_delay_s=" + simulation::number_text(values[i]));
        break;
      case Changes::sensor_noise:
        walk.sensor_noise_scale = values[i];
        break;
      case Changes::push_phase:
        walk.push_start_s = lift_off_s(timing.settled_s, timing.step_time_s, values[i]);
        break;
    }
  }
}

}  // namespace stilt::experiments
