#include "host_tools/simulation/plant/plant_options.h"

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <stdexcept>
#include <vector>

#include "host_tools/simulation/plant/number.h"

namespace stilt::simulation {
namespace {

using Options = PlantOptions;

/// Mass, inertia and centre of mass of one link.
void add_link_options(std::size_t link, const std::string& key, const std::string& name,
                      std::vector<PlantOption>& table) {
  const auto add = [&](const char* quantity, double LinkChange::* value, const char* unit, double minimum,
                       double maximum, const char* default_text, const std::string& description) {
    table.push_back({key + quantity, unit, minimum, maximum, default_text, description,
                     [link, value](Options& o, double v) { o.links[link].*value = v; }});
  };
  add("_mass_scale", &LinkChange::mass_scale, "-", 0.2, 5.0, "1", "factor on the mass of the " + name);
  add("_inertia_scale", &LinkChange::inertia_scale, "-", 0.2, 5.0, "1",
      "factor on the inertia of the " + name);
  add("_com_x_m", &LinkChange::com_x_m, "m", -0.2, 0.2, "0",
      "shift of the centre of mass of the " + name + ", forward");
  add("_com_z_m", &LinkChange::com_z_m, "m", -0.2, 0.2, "0",
      "shift of the centre of mass of the " + name + ", up");
}

std::vector<PlantOption> make_table() {
  std::vector<PlantOption> table = {
      PlantOption{"time_step_s", "s", 1e-5, 5e-4, "0.0005",
                  "longest step of the physics engine; shortened to divide the control tick",
                  [](Options& o, double v) { o.time_step_s = v; }},
      PlantOption{"mass_scale", "-", 0.2, 5.0, "1", "factor on mass and inertia of every link",
                  [](Options& o, double v) { o.mass_scale = v; }},
  };
  add_link_options(0, "torso", "torso", table);
  add_link_options(1, "thigh_L", "left thigh", table);
  add_link_options(2, "shin_L", "left shin", table);
  add_link_options(3, "thigh_R", "right thigh", table);
  add_link_options(4, "shin_R", "right shin", table);
  const std::vector<PlantOption> others = {
      PlantOption{"friction", "-", 0.01, 5.0, "0.6", "friction coefficient between foot and ground",
                  [](Options& o, double v) { o.friction = v; }},
      PlantOption{"armature", "kg m^2", 0.0, 10.0, "from the URDF", "armature of every joint",
                  [](Options& o, double v) { o.armature_kg_m2 = v; }},
      PlantOption{"armature_scale", "-", 0.0, 10.0, "1", "factor on the armature of every joint",
                  [](Options& o, double v) { o.armature_scale = v; }},
      PlantOption{"joint_damping", "Nm s/rad", 0.0, 100.0, "from the URDF", "viscous friction of every joint",
                  [](Options& o, double v) { o.joint_damping_Nms_rad = v; }},
      PlantOption{"joint_friction_Nm", "Nm", 0.0, 100.0, "from the URDF",
                  "Coulomb friction of every joint, MuJoCo's frictionloss",
                  [](Options& o, double v) { o.joint_friction_Nm = v; }},
      PlantOption{"torque_limit_Nm", "Nm", 0.0, 10000.0, "from the URDF", "largest torque of every motor",
                  [](Options& o, double v) { o.torque_limit_Nm = v; }},
      PlantOption{"torque_limit_scale", "-", 0.0, 10.0, "1",
                  "factor on the largest torque of every motor; the controller keeps its limit",
                  [](Options& o, double v) { o.torque_limit_scale = v; }},
      PlantOption{
          "no_load_speed_rad_s", "rad/s", 0.0, 1000.0, "0, no limit",
          "joint speed at which a motor's driving torque ends; falls linearly to there, braking stays",
          [](Options& o, double v) { o.no_load_speed_rad_s = v; }},
      PlantOption{"drive_time_constant_s", "s", 0.0, 0.1, "0",
                  "first-order lag from the torque after delay and limit to the torque that acts",
                  [](Options& o, double v) { o.drive_time_constant_s = v; }},
      PlantOption{"torso_com_m", "m", 0.0, 1.0, "from the URDF",
                  "height of the torso's centre of mass above the hip; the controller keeps its model",
                  [](Options& o, double v) { o.torso_com_m = v; }},
      PlantOption{"joint_stops", "-", 0.0, 1.0, "0", "1: stops at the limits of the joints",
                  [](Options& o, double v) { o.joint_stops = v == 1.0; }, true},
      PlantOption{"foot_radius_m", "m", 0.0005, 0.05, "0.002", "radius of the foot sphere",
                  [](Options& o, double v) { o.foot_radius_m = v; }},
      PlantOption{
          "contact_time_constant_s", "s", 2e-5, 0.1, "0.004",
          "time constant of foot on ground (MuJoCo solref), at least two physics steps; smaller: stiffer",
          [](Options& o, double v) { o.contact_time_constant_s = v; }},
      PlantOption{"contact_damping_ratio", "-", 0.1, 10.0, "1",
                  "damping ratio of foot on ground (MuJoCo solref); below 1 the foot rebounds",
                  [](Options& o, double v) { o.contact_damping_ratio = v; }},
      PlantOption{"encoder_noise_rad", "rad", 0.0, 1.0, "0", "standard deviation of a joint position",
                  [](Options& o, double v) { o.encoder_noise_rad = v; }},
      PlantOption{"encoder_velocity_noise_rad_s", "rad/s", 0.0, 10.0, "0",
                  "standard deviation of a joint velocity",
                  [](Options& o, double v) { o.encoder_velocity_noise_rad_s = v; }},
      PlantOption{"base_pitch_noise_rad", "rad", 0.0, 1.0, "0", "standard deviation of the base pitch",
                  [](Options& o, double v) { o.base_pitch_noise_rad = v; }},
      PlantOption{"base_pitch_rate_noise_rad_s", "rad/s", 0.0, 10.0, "0",
                  "standard deviation of the base pitch rate",
                  [](Options& o, double v) { o.base_pitch_rate_noise_rad_s = v; }},
      PlantOption{"base_pitch_bias_rad", "rad", -0.5, 0.5, "0",
                  "added to the base pitch: mounting error and bias of its sensor",
                  [](Options& o, double v) { o.base_pitch_bias_rad = v; }},
      PlantOption{"base_pitch_rate_bias_rad_s", "rad/s", -1.0, 1.0, "0", "added to the base pitch rate",
                  [](Options& o, double v) { o.base_pitch_rate_bias_rad_s = v; }},
      PlantOption{"encoder_resolution_rad", "rad", 0.0, 0.1, "0",
                  "joint positions and base pitch are multiples of it, noise included",
                  [](Options& o, double v) { o.encoder_resolution_rad = v; }},
      PlantOption{
          "encoder_velocity_resolution_rad_s", "rad/s", 0.0, 10.0, "0",
          "joint velocities and base pitch rate are multiples of it: a drive's observer, in its frame",
          [](Options& o, double v) { o.encoder_velocity_resolution_rad_s = v; }},
      PlantOption{"delay_s", "s", 0.0, 0.1, "0", "time from a measurement to the torque computed from it",
                  [](Options& o, double v) { o.delay_s = v; }},
      PlantOption{"base_pitch_resolution_rad", "rad", 0.0, 0.1, "0",
                  "base pitch is a multiple of it; 0: of encoder_resolution_rad",
                  [](Options& o, double v) { o.base_pitch_resolution_rad = v; }},
      PlantOption{"base_pitch_rate_resolution_rad_s", "rad/s", 0.0, 10.0, "0",
                  "base pitch rate is a multiple of it; 0: of encoder_velocity_resolution_rad_s",
                  [](Options& o, double v) { o.base_pitch_rate_resolution_rad_s = v; }},
      PlantOption{
          "reading_delay_s", "s", 0.0, 0.1, "0",
          "age of the readings in whole ticks: on a bus the reply to a command is read in the next tick",
          [](Options& o, double v) { o.reading_delay_s = v; }},
      PlantOption{"ground_slope_rad", "rad", -0.5, 0.5, "0", "slope of the ground, positive uphill forward",
                  [](Options& o, double v) { o.ground_slope_rad = v; }},
      PlantOption{"step_height_m", "m", -0.3, 0.3, "0",
                  "height of a step in the ground, negative down; what is raised ends 100 m from the start",
                  [](Options& o, double v) { o.step_height_m = v; }},
      PlantOption{"step_position_m", "m", -99.0, 99.0, "2", "where the step in the ground begins, forward",
                  [](Options& o, double v) { o.step_position_m = v; }},
  };
  table.insert(table.end(), others.begin(), others.end());
  return table;
}

const std::vector<PlantOption>& table() {
  static const std::vector<PlantOption> made = make_table();
  return made;
}

const PlantOption& find_option(std::string_view key) {
  for (const PlantOption& option : table()) {
    if (key == option.key) return option;
  }
  std::string known;
  for (const PlantOption& option : table()) known += (known.empty() ? "" : ", ") + option.key;
  throw std::invalid_argument("--plant " + std::string(key) + ": no such plant option; known are " + known);
}

std::string range_text(const PlantOption& option) {
  if (option.is_switch) return "0 or 1";
  return number_text(option.minimum) + " to " + number_text(option.maximum) +
         (std::string_view(option.unit) == "-" ? "" : std::string(" ") + option.unit);
}

}  // namespace

double ground_height_m(const PlantOptions& options, double x_m) {
  const double step_m = x_m >= options.step_position_m ? options.step_height_m : 0.0;
  return x_m * std::tan(options.ground_slope_rad) + step_m;
}

std::span<const PlantOption> plant_option_table() { return table(); }

std::string describe_plant_options() {
  std::string text;
  for (const PlantOption& option : table()) {
    char line[256];
    std::snprintf(line, sizeof line, "  %-34s %s (%s; default %s)\n", option.key.c_str(),
                  option.description.c_str(), range_text(option).c_str(), option.default_text);
    text += line;
  }
  return text;
}

void set_plant_option(PlantOptions& options, std::string_view assignment) {
  const std::string whole(assignment);
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos) {
    throw std::invalid_argument("--plant " + whole + ": expected KEY=VALUE, for example friction=0.4");
  }
  const PlantOption& option = find_option(assignment.substr(0, equals));
  const std::optional<double> value = parse_number(assignment.substr(equals + 1));
  const bool in_range = value && *value >= option.minimum && *value <= option.maximum;
  if (!in_range || (option.is_switch && *value != 0.0 && *value != 1.0)) {
    throw std::invalid_argument("--plant " + whole + ": " + option.key + " must be " +
                                (option.is_switch ? "" : "a number from ") + range_text(option));
  }
  option.set(options, *value);
}

double time_step_for_tick(double wished_s, double tick_s) {
  return tick_s / std::ceil(tick_s / wished_s - 1e-9);
}

}  // namespace stilt::simulation
