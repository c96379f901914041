#pragma once

#include "codegen/model/equations.h"

namespace stilt::codegen {

/// The numbers of every robot of a shape with straight links and two equal legs, as parameters p[NAME] of the
/// names that shape_numbers() gives; both legs have the same ones. `tree` is any robot of the shape.
[[nodiscard]] TreeNumbers shape_parameters(Graph& graph, const PlanarTree& tree);

}  // namespace stilt::codegen
