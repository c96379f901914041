#pragma once

#include <optional>
#include <string>
#include <vector>

#include "codegen/urdf/planar_tree.h"

/// The robot of a URDF as a MuJoCo model. Plant and controller's model therefore have the same source.
namespace stilt::simulation {

/// A step of the ground: from position_m to the next step the ground is height_m above (or below) the level
/// at the origin.
struct GroundStep {
  double position_m = 0.0;
  double height_m = 0.0;
};

/// Options of the robot's world.
struct MjcfOptions {
  double time_step_s = 0.0005;
  double foot_radius_m = 0.002;
  double friction = 0.6;
  double ground_slope_rad = 0.0;       ///< positive: the ground rises towards +x
  std::vector<GroundStep> steps = {};  ///< in order of position; empty: flat ground
  bool contacts = true;
  bool joint_limits = false;                   ///< stops at the limits of the joints
  bool armature = true;                        ///< at the joints
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
/// Coordinates: slides x and z and a hinge about +y named root_x, root_z, root_pitch. Then the joints by
/// name, in the order of the tree. qpos and qvel are q and v of the project. Masses, centres of mass
/// and inertias about y are exact. The other two principal inertias, which have no effect in the plane, equal
/// that about y. Each foot is a sphere whose lowest point is the foot frame when the leg is vertical. Its
/// geom and site have the foot's name. Feet touch only the ground. More sites: hip (the base frame),
/// torso_com. Each joint has a motor actuator of its name (control in Nm). Gravity -9.81 m/s^2, elliptic
/// friction cone, Newton solver.
[[nodiscard]] std::string to_mjcf(const codegen::PlanarTree& tree, const MjcfOptions& options);

}  // namespace stilt::simulation
