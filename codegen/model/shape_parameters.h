#pragma once

#include "codegen/model/equations.h"

namespace stilt::codegen {

/// The numbers of a robot with straight links and two equal legs as parameters p[NAME], with the names of
/// shape_numbers(). Both legs share their parameters. `tree` is any robot of the shape.
[[nodiscard]] TreeNumbers shape_parameters(Graph& graph, const PlanarTree& tree);

}  // namespace stilt::codegen
