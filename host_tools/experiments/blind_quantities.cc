#include "host_tools/experiments/blind_limits.h"
#include "host_tools/experiments/walks.h"
#include "host_tools/simulation/plant/number.h"

namespace stilt::experiments {
namespace {

constexpr double kStepPosition_m = 2.0;
constexpr double kBeyondStep_m = 1.0;

std::string assignment(const char* key, double value) {
  return std::string(key) + "=" + simulation::number_text(value);
}

bool survives(const WalkCase&, const log::RunSummary& summary) { return summary.survived; }

void set_step(double height_m, double phase_m, WalkCase& walk) {
  walk.plant = {assignment("step_height_m", height_m),
                assignment("step_position_m", kStepPosition_m + phase_m)};
}

/// A robot that stops before the step has not passed it.
bool passes_step(const WalkCase&, const log::RunSummary& summary) {
  return summary.survived && summary.distance_m > kStepPosition_m + kBeyondStep_m;
}

void set_slope(double slope_rad, double, WalkCase& walk) {
  walk.plant = {assignment("ground_slope_rad", slope_rad)};
}

void set_speed(double speed_m_s, double, WalkCase& walk) { walk.command.speed_m_s = speed_m_s; }

bool walks_at_it(const WalkCase& walk, const log::RunSummary& summary) {
  return walks(walk.command, summary);
}

void set_friction(double friction, double, WalkCase& walk) {
  walk.plant = {assignment("friction", friction)};
}

void set_mass(double scale, double, WalkCase& walk) { walk.plant = {assignment("mass_scale", scale)}; }

void set_plan_delay(double delay_s, double, WalkCase& walk) {
  walk.settings = {assignment("timing.plan_delay_s", delay_s)};
}

void set_delay(double delay_s, double, WalkCase& walk) { walk.plant = {assignment("delay_s", delay_s)}; }

/// On a steeper slope a foot of the first stand is out of the leg's reach.
constexpr double kSlopeOfTheStand_rad = 0.38;

}  // namespace

const std::vector<BlindQuantity>& blind_quantities() {
  static const std::vector<BlindQuantity> kQuantities = {
      {"step_up", "ground step", "m", "up", 0.0, {0.02, 0.005, 0.3}, true, set_step, passes_step},
      {"step_down", "ground step", "m", "down", 0.0, {-0.04, -0.01, -0.28}, true, set_step, passes_step},
      {"slope_up", "slope", "rad", "up", 0.0, {0.05, 0.01, kSlopeOfTheStand_rad}, false, set_slope, survives},
      {"slope_down",
       "slope",
       "rad",
       "down",
       0.0,
       {-0.05, -0.01, -kSlopeOfTheStand_rad},
       false,
       set_slope,
       survives},
      {"speed_forward", "speed", "m/s", "forward", 0.0, {0.2, 0.05, 3.0}, false, set_speed, walks_at_it},
      {"speed_backward", "speed", "m/s", "backward", 0.0, {-0.2, -0.05, -3.0}, false, set_speed, walks_at_it},
      {"friction", "friction", "1", "down", 0.6, {-0.1, -0.02, -0.5}, false, set_friction, survives},
      {"mass_up", "mass factor", "1", "up", 1.0, {0.1, 0.02, 3.0}, false, set_mass, survives},
      {"mass_down", "mass factor", "1", "down", 1.0, {-0.1, -0.02, -0.8}, false, set_mass, survives},
      {"plan_delay", "plan delay", "s", "up", 0.002, {0.005, 0.001, 0.198}, false, set_plan_delay, survives},
      {"torque_delay", "torque delay", "s", "up", 0.0, {0.002, 0.001, 0.1}, false, set_delay, survives},
  };
  return kQuantities;
}

}  // namespace stilt::experiments
