#pragma once

#include <map>
#include <set>
#include <span>
#include <utility>

#include "codegen/expression/graph.h"

namespace stilt::codegen {

/// Exact symbolic differentiation with shared results.
///
/// The variables given are *cut nodes*: any node may be one (a symbol, a sum of angles, a solved
/// acceleration). A variable's derivative with respect to itself is one and with respect to the other
/// variables zero, whatever stands beneath it, so chains can be applied by hand where structure makes that
/// cheaper. Other symbols are held constant. The canonical form of the graph moves signs and constant factors
/// out of a variable -a or c a, so the node that is cut is a.
class Differentiator {
 public:
  /// @throws std::invalid_argument if a variable is a constant.
  explicit Differentiator(std::span<const Expression> variables);

  /// d expression / d variable. The variable must be one of those given.
  /// @throws std::invalid_argument otherwise.
  [[nodiscard]] Expression operator()(Expression expression, Expression variable);

 private:
  [[nodiscard]] Expression derive(Expression e, Expression variable);

  std::set<int> variables_;
  std::map<std::pair<int, int>, Expression> memo_;
};

}  // namespace stilt::codegen
