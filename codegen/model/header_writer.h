#pragma once

#include <map>
#include <string>

#include "codegen/urdf/planar_tree.h"

namespace stilt::codegen {

/// The generated headers of a robot: file name -> text. `source` is the URDF's path as the first lines quote
/// it, `robot` the namespace inside stilt::generated.
[[nodiscard]] std::map<std::string, std::string> write_headers(const PlanarTree& tree,
                                                               const std::string& robot,
                                                               const std::string& source);

}  // namespace stilt::codegen
