#pragma once

#include <map>
#include <string>
#include <vector>

#include "codegen/expression/graph.h"

namespace stilt::codegen {

/// A value that a generated function writes: `path = value`, path as in "out.bias[3]".
struct Output {
  std::string path;
  Expression value;
};

/// Floating-point work of a function, each operation counted by itself (a fused multiply-add is two).
struct OperationCount {
  int additions = 0;  ///< and subtractions
  int multiplications = 0;
  int divisions = 0;
  int negations = 0;
  int sine_cosine_pairs = 0;

  [[nodiscard]] int total() const { return additions + multiplications + divisions + negations; }
};

/// A function to emit.
struct FunctionSpec {
  std::string name;
  std::string documentation;            ///< one or more lines, without comment marks
  std::vector<std::string> parameters;  ///< pointers to read from, in order: "x", "u", ...
  std::vector<Output> outputs;
};

/// A function as C++ text: straight-line, branch-free, only live nodes, each once, in depth-first order of
/// the outputs so that values are used soon after they are computed. A template over the scalar T and the
/// output struct Out. Sines and cosines call `sincos(angle, sine, cosine)`.
struct EmittedFunction {
  std::string text;
  OperationCount count;
};

/// Coefficients that emitted functions read from an array instead of computing them, each once.
class CoefficientTable {
 public:
  /// The place of a coefficient, the next free one when it has none yet.
  int place(Expression coefficient);
  [[nodiscard]] const std::vector<Expression>& entries() const { return entries_; }

 private:
  std::vector<Expression> entries_;
  std::map<int, int> places_;
};

/// With a table, the largest coefficients that are no constants are elements of the parameter `k`, and are
/// entered into the table; without one they are computed like everything else.
[[nodiscard]] EmittedFunction emit_function(const FunctionSpec& spec,
                                            CoefficientTable* coefficients = nullptr);

/// The shortest decimal text that reads back as the same double, always with a point or exponent.
[[nodiscard]] std::string number_text(double value);

}  // namespace stilt::codegen
