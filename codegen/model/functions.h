#pragma once

#include <vector>

#include "codegen/expression/emit.h"
#include "codegen/model/equations.h"

namespace stilt::codegen {

/// Specifications of the generated functions. The graph of `equations` holds the expressions and must outlive
/// them. Each specification documents shapes and meaning.
[[nodiscard]] std::vector<FunctionSpec> kinematic_functions(
    const Equations& equations);  ///< kinematics, mass matrix, bias
[[nodiscard]] std::vector<FunctionSpec> node_functions(
    const Equations& equations);  ///< flow, node, derivatives
/// Map and derivatives of the impact that brings these feet to rest.
[[nodiscard]] std::vector<FunctionSpec> impact_functions(const Equations& equations,
                                                         const std::vector<int>& feet);

/// Text "name[1]" or "name[1][2]".
[[nodiscard]] std::string element(const std::string& name, int row);
[[nodiscard]] std::string element(const std::string& name, int row, int column);

/// Appends every element of a vector or matrix as an output.
void append(std::vector<Output>& outputs, const std::string& name, const Row& row);
void append(std::vector<Output>& outputs, const std::string& name, const Matrix& matrix);

}  // namespace stilt::codegen
