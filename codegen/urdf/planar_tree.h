#pragma once

#include <string>
#include <vector>

/// A planar robot: a tree of rigid links in the x-z plane on a floating base.
///
/// World: x forward, z up. Angles are rotations about +y. A vector (x, z) turned by a is (x cos a + z sin a,
/// -x sin a + z cos a). A link that hangs down therefore swings to -x at positive angles.
namespace stilt::codegen {

struct PlanarVector {
  double x = 0.0;
  double z = 0.0;
};

/// The joint that carries a link, about +y (direction 1) or -y (direction -1).
struct PlanarJoint {
  std::string name;
  PlanarVector origin_m;          ///< in the parent link's frame
  double angle_offset_rad = 0.0;  ///< of the link's frame relative to the parent's at joint angle zero
  double direction = 1.0;
  double position_min_rad = 0.0;
  double position_max_rad = 0.0;
  double velocity_max_rad_s = 0.0;
  double torque_max_Nm = 0.0;
  double damping_Nm_s = 0.0;  ///< viscous, Nm per rad/s
  double friction_Nm = 0.0;   ///< Coulomb
  double gear_ratio = 1.0;
  double rotor_inertia_kg_m2 = 0.0;  ///< on the motor's side of the gear

  /// Inertia that the rotor adds at the joint.
  [[nodiscard]] double armature_kg_m2() const { return gear_ratio * gear_ratio * rotor_inertia_kg_m2; }
};

/// A rigid body, with all links fixed to it merged in.
struct PlanarLink {
  std::string name;
  int parent = -1;    ///< index of the parent link, smaller than the link's own; -1 for the root
  PlanarJoint joint;  ///< to the parent; unused for the root
  double mass_kg = 0.0;
  PlanarVector com_m;          ///< in the link's frame
  double inertia_kg_m2 = 0.0;  ///< about the centre of mass, about y
};

/// A massless point fixed to a link that may touch the ground.
struct PlanarFoot {
  std::string name;
  int link = 0;
  PlanarVector position_m;  ///< in the link's frame
};

/// links[0] is the floating base; joint i carries links[i + 1].
struct PlanarTree {
  std::string name;
  std::vector<PlanarLink> links;
  std::vector<PlanarFoot> feet;

  [[nodiscard]] int link_count() const { return static_cast<int>(links.size()); }
  [[nodiscard]] int joint_count() const { return link_count() - 1; }
  [[nodiscard]] int foot_count() const { return static_cast<int>(feet.size()); }
  /// Generalised coordinates: x and z of the base, its pitch, the joints.
  [[nodiscard]] int position_count() const { return 2 + link_count(); }
  [[nodiscard]] double mass_kg() const;
  /// Indices of the links from the root to the given one, both included.
  [[nodiscard]] std::vector<int> path_to(int link) const;
};

}  // namespace stilt::codegen
