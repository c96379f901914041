#pragma once

#include <string>
#include <vector>

#include "codegen/urdf/planar_tree.h"

namespace stilt::codegen {

/// A number of a robot that the generated functions take as an argument.
struct ShapeNumber {
  std::string name;  ///< link and quantity: "thigh_mass_kg"
  double value = 0.0;
};

/// Quantities of a link that are numbers of the shape, for both sides.
enum class ShapeQuantity {
  mass_kg,
  com_m,          ///< distance of the centre of mass from the link's joint: above it for the base, else below
  inertia_kg_m2,  ///< about the centre of mass
  length_m,       ///< distance of the link's next joint, or of its foot, below its own joint
};

/// Name of a number: "thigh_mass_kg" for link thigh_L or thigh_R.
[[nodiscard]] std::string number_name(const PlanarLink& link, ShapeQuantity quantity);

/// Numbers of a robot with straight links and two equal legs. Those of the base come first, then those of
/// each link of the left leg, from the hip down. Links and coordinates are those of a PlanarTree; `source`
/// begins every error message.
/// @throws UrdfError for a robot that these numbers do not describe. The message is one sentence with the
/// element and what would be right. Refused are joints about -y, joints of the base off its origin, and bent
/// or turned links. So are centres of mass off the line of the joints, and branches other than at the base.
/// So are a leg without a foot at its end, a foot at the other leg, and legs that differ.
[[nodiscard]] std::vector<ShapeNumber> shape_numbers(const PlanarTree& tree, const std::string& source);

}  // namespace stilt::codegen
