#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "mpc_core/model/types.h"

/// Differences between the simulated robot and the controller's model.
namespace stilt::simulation {

/// Change of one link against the robot's URDF.
struct LinkChange {
  double mass_scale = 1.0;
  double inertia_scale = 1.0;  ///< of the inertia about the centre of mass
  double com_x_m = 0.0;        ///< added to the centre of mass, in the link's frame: x forward and z up while
  double com_z_m = 0.0;        ///< the robot is upright with all joint angles zero
};

/// Options of the plant. An empty optional keeps the value of the robot's URDF.
struct PlantOptions {
  double time_step_s = 0.0005;
  double mass_scale = 1.0;                             ///< of every link
  std::array<LinkChange, 1 + model::kJoints> links{};  ///< torso, thigh_L, shin_L, thigh_R, shin_R
  double friction = 0.6;
  std::optional<double> armature_kg_m2;
  double armature_scale = 1.0;
  std::optional<double> joint_damping_Nms_rad;
  std::optional<double> joint_friction_Nm;
  std::optional<double> torque_limit_Nm;
  double torque_limit_scale = 1.0;
  double no_load_speed_rad_s = 0.0;        ///< of every joint; 0: the torque limit does not depend on the
                                           ///< speed
  double base_pitch_resolution_rad = 0.0;  ///< of the base pitch; 0: that of the encoders
  double base_pitch_rate_resolution_rad_s = 0.0;  ///< of its rate; 0: that of the encoders
  double reading_delay_s = 0.0;        ///< age of the readings that the controller gets, in whole ticks
  double drive_time_constant_s = 0.0;  ///< 0: the torque follows its command without lag
  std::optional<double> torso_com_m;   ///< height above the hip
  bool joint_stops = false;
  double foot_radius_m = 0.002;
  double contact_time_constant_s = 0.004;  ///< MuJoCo solref[0], at least twice the time step
  double contact_damping_ratio = 1.0;      ///< MuJoCo solref[1]
  double encoder_noise_rad = 0.0;
  double encoder_velocity_noise_rad_s = 0.0;
  double base_pitch_noise_rad = 0.0;
  double base_pitch_rate_noise_rad_s = 0.0;
  double base_pitch_bias_rad = 0.0;  ///< added to the base pitch: mounting error and bias of its sensor
  double base_pitch_rate_bias_rad_s = 0.0;         ///< added to its rate
  double encoder_resolution_rad = 0.0;             ///< 0: not quantised
  double encoder_velocity_resolution_rad_s = 0.0;  ///< 0: not quantised
  double delay_s = 0.0;
  double ground_slope_rad = 0.0;
  double step_height_m = 0.0;
  double step_position_m = 2.0;
};

/// Height of the ground at a point x of the world.
[[nodiscard]] double ground_height_m(const PlantOptions& options, double x_m);

/// One row of the table of options: what `--plant KEY=VALUE` accepts.
struct PlantOption {
  std::string key;
  const char* unit;
  double minimum;
  double maximum;
  const char* default_text;
  std::string description;
  std::function<void(PlantOptions&, double)> set;
  bool is_switch = false;  ///< the only values are 0 and 1
};

/// The table of options, in the order of the help text.
[[nodiscard]] std::span<const PlantOption> plant_option_table();

/// The table as text, one option per line.
[[nodiscard]] std::string describe_plant_options();

/// Sets one option from "KEY=VALUE". Throws std::invalid_argument, one sentence, when the key is unknown, or
/// when the value is not a number or out of range.
void set_plant_option(PlantOptions& options, std::string_view assignment);

/// Longest time step, not above `wished_s`, that divides the tick.
[[nodiscard]] double time_step_for_tick(double wished_s, double tick_s);

}  // namespace stilt::simulation
