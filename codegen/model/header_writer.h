#pragma once

#include <map>
#include <string>

#include "codegen/urdf/planar_tree.h"

namespace stilt::codegen {

/// The generated headers of a shape: file name -> text. `tree` is any robot of the shape; `source` begins the
/// error messages of shape_numbers(); `shape` is the namespace inside stilt::generated. The functions take
/// the coefficients of a robot, which prepare() computes from its numbers. The impact is generated for the
/// left foot and for both feet; that of the right foot follows, because both legs are equal.
[[nodiscard]] std::map<std::string, std::string> write_headers(const PlanarTree& tree,
                                                               const std::string& source,
                                                               const std::string& shape);

}  // namespace stilt::codegen
