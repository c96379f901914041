#pragma once

#include <string>

#include "codegen/urdf/planar_tree.h"
#include "codegen/urdf/urdf_error.h"

namespace stilt::codegen {

/// Reads a URDF file and reduces it to a planar tree.
///
/// The root link is the floating base. Every moving joint must turn about +y or -y (revolute or continuous).
/// Fixed joints may turn about y only; offsets along y are dropped. Links behind fixed joints are merged into
/// the link that carries them. Feet are the massless links foot_L and foot_R behind fixed joints, in this
/// order. Joints are in depth-first order, and at each link in the order of the document. Names ending in _L
/// come before those ending in _R.
///
/// Limits, damping and Coulomb friction are the URDF's. The armature is that of the joint's <transmission>,
/// below <robot> or below a <ros2_control>. A transmission has one <joint> and one <actuator>. One of them
/// has <mechanicalReduction>, as ROS 1 writes it, or <mechanical_reduction>. All joints or none have
/// <rotorInertia> in the <actuator> (kg m^2 on the motor's side, an extension of this project). Without it
/// there is no armature. <mimic> is refused.
///
/// @throws UrdfError for a file that cannot be read, is not a URDF, not a tree or not planar. Also for a
/// massless moving link, a joint without limits, or no foot.
[[nodiscard]] PlanarTree read_urdf(const std::string& file);

/// Reads the text of a URDF in the same way; `source` names it in error messages.
[[nodiscard]] PlanarTree parse_urdf(const std::string& text, const std::string& source);

}  // namespace stilt::codegen
