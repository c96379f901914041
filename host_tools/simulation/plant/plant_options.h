#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

/// What may differ between the simulated robot and the model of the controller.
namespace stilt::simulation {

/// Options of the plant. An empty optional keeps the value of the robot's URDF.
struct PlantOptions {
  double time_step_s = 0.0005;
  double mass_scale = 1.0;
  double friction = 0.6;
  std::optional<double> armature_kg_m2;
  std::optional<double> joint_damping_Nms_rad;
  std::optional<double> joint_friction_Nm;
  std::optional<double> torque_limit_Nm;
  double no_load_speed_rad_s = 0.0;         ///< of every joint; 0: the torque does not depend on the speed
  double base_resolution_rad = 0.0;         ///< of the base pitch; 0: that of the encoders
  double base_rate_resolution_rad_s = 0.0;  ///< of its rate; 0: that of the encoders
  double reading_delay_s = 0.0;             ///< age of the readings that the controller gets, in whole ticks
  double drive_time_constant_s = 0.0;       ///< 0: the torque follows its command at once
  std::optional<double> torso_com_m;        ///< height above the hip
  bool joint_stops = false;
  double foot_radius_m = 0.002;
  double contact_time_constant_s = 0.004;  ///< MuJoCo solref[0], at least twice the time step
  double contact_damping_ratio = 1.0;      ///< MuJoCo solref[1]
  double encoder_noise_rad = 0.0;
  double encoder_velocity_noise_rad_s = 0.0;
  double base_angle_noise_rad = 0.0;
  double base_rate_noise_rad_s = 0.0;
  double encoder_resolution_rad = 0.0;             ///< 0: not quantised
  double encoder_velocity_resolution_rad_s = 0.0;  ///< 0: not quantised
  double delay_s = 0.0;
  double ground_slope_rad = 0.0;
  double step_height_m = 0.0;
  double step_position_m = 2.0;
};

/// Height of the ground below a point x of the world.
[[nodiscard]] double ground_height_m(const PlantOptions& options, double x_m);

/// One row of the table of options: what `--plant KEY=VALUE` accepts.
struct PlantOption {
  const char* key;
  const char* unit;
  double minimum;
  double maximum;
  const char* default_text;
  const char* description;
  void (*set)(PlantOptions&, double);
  bool is_switch = false;  ///< takes 0 and 1, nothing between
};

/// The table of options, in the order of the help text.
[[nodiscard]] std::span<const PlantOption> plant_option_table();

/// The table as text, one option a line.
[[nodiscard]] std::string describe_plant_options();

/// Sets one option from "KEY=VALUE". Throws std::invalid_argument, one sentence, when the key is unknown, the
/// value no number or out of its range.
void set_plant_option(PlantOptions& options, std::string_view assignment);

}  // namespace stilt::simulation
