#pragma once

#include <map>
#include <set>
#include <span>
#include <utility>

#include "codegen/expression/graph.h"

namespace stilt::codegen {

/// Exact symbolic differentiation with shared results.
///
/// The variables given are *cut nodes*. Any node may be one: a symbol, a sum of angles, a solved
/// acceleration. A variable's derivative is one with respect to itself and zero with respect to the other
/// variables, whatever it is computed from. Where structure makes the chain rule cheaper, the caller can
/// apply it by hand. Other symbols are held constant. The canonical form of the graph moves signs and
/// constant factors out of a variable -a or c a. The node cut is then a.
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
