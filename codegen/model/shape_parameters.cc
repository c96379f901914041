#include "codegen/model/shape_parameters.h"

#include <cstddef>

#include "codegen/urdf/shape_numbers.h"

// Numbers of a robot as arguments: docs/decisions/0016-robots-as-data.md
namespace stilt::codegen {

TreeNumbers shape_parameters(Graph& graph, const PlanarTree& tree) {
  const Expression zero = graph.constant(0.0);
  const auto parameter = [&](const PlanarLink& link, ShapeQuantity quantity) {
    return graph.parameter("p[" + number_name(link, quantity) + "]");
  };
  TreeNumbers numbers;
  for (const PlanarLink& link : tree.links) {
    const Expression com_m = parameter(link, ShapeQuantity::com_m);
    PlanarExpression origin_m{zero, zero};
    if (link.parent > 0) {
      const PlanarLink& parent = tree.links[static_cast<std::size_t>(link.parent)];
      origin_m.z = -parameter(parent, ShapeQuantity::length_m);
    }
    numbers.links.push_back({.mass_kg = parameter(link, ShapeQuantity::mass_kg),
                             .com_m = {zero, link.parent < 0 ? com_m : -com_m},
                             .inertia_kg_m2 = parameter(link, ShapeQuantity::inertia_kg_m2),
                             .origin_m = origin_m,
                             .angle_offset_rad = zero});
  }
  for (const PlanarFoot& foot : tree.feet) {
    const PlanarLink& link = tree.links[static_cast<std::size_t>(foot.link)];
    numbers.feet_m.push_back({zero, -parameter(link, ShapeQuantity::length_m)});
  }
  return numbers;
}

}  // namespace stilt::codegen
