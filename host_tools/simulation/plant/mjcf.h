#pragma once

#include <optional>
#include <string>
#include <vector>

#include "codegen/urdf/planar_tree.h"

/// The robot of a URDF as a MuJoCo model, so that the plant and the controller's model have one source.
namespace stilt::simulation {

/// A change of the ground's level: from position_m on, the ground stands height_m over (or under) the level
/// at the origin, until the next step.
struct GroundStep {
  double position_m = 0.0;
  double height_m = 0.0;
};

/// How the robot's world is built.
struct MjcfOptions {
  double time_step_s = 0.0005;
  double foot_radius_m = 0.002;
  double friction = 0.6;
  double ground_slope_rad = 0.0;       ///< positive: the ground rises towards +x
  std::vector<GroundStep> steps = {};  ///< in order of position; none: flat ground
  bool contacts = true;
  bool joint_limits = false;                   ///< stops at the ends of the joints' ranges
  bool armature = true;                        ///< reflected rotor inertia at the joints
  bool joint_losses = true;                    ///< viscous damping and Coulomb friction at the joints
  double contact_time_constant_s = 0.004;      ///< MuJoCo solref[0], at least twice the time step
  double contact_damping_ratio = 1.0;          ///< MuJoCo solref[1]
  double contact_impedance_min = 0.95;         ///< MuJoCo solimp[0]
  double contact_impedance_max = 0.999;        ///< MuJoCo solimp[1]
  double contact_impedance_width_m = 0.001;    ///< MuJoCo solimp[2]
  double friction_to_normal_impedance = 10.0;  ///< MuJoCo impratio; larger: less creep of a loaded foot
};

/// MJCF text of a planar tree.
///
/// Coordinates: slides x and z and a hinge about +y named root_x, root_z, root_pitch, then the joints by
/// their names, in the order of the tree: qpos and qvel are q and v of the project. Masses, centres of mass
/// and inertias about y are exact; the other two principal inertias, which nothing in the plane sees, equal
/// that about y. Each foot is a sphere whose lowest point is the foot frame when the leg is vertical, with
/// geom and site of the foot's name; feet touch only the ground. More sites: hip (the base frame), torso_com.
/// Each joint has a motor actuator of its name (control in Nm). Gravity -9.81 m/s^2, elliptic friction cone,
/// Newton solver.
[[nodiscard]] std::string to_mjcf(const codegen::PlanarTree& tree, const MjcfOptions& options);

}  // namespace stilt::simulation
