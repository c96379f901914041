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

/// Floating-point operations of a function. Every operation counts as one, a fused multiply-add as two.
struct OperationCount {
  int additions = 0;  ///< with subtractions
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

/// A function as C++ text: straight-line and branch-free. It computes each live node once, in depth-first
/// order of the outputs, so that values are used soon after they are computed. A template over the scalar T
/// and the output struct Out. Sines and cosines call `sincos(angle, sine, cosine)`.
struct EmittedFunction {
  std::string text;
  OperationCount count;
};

/// Coefficients that emitted functions read from an array instead of computing them; each is stored once.
class CoefficientTable {
 public:
  /// Index of a coefficient; a new coefficient is appended.
  int place(Expression coefficient);
  [[nodiscard]] const std::vector<Expression>& entries() const { return entries_; }

 private:
  std::vector<Expression> entries_;
  std::map<int, int> places_;
};

/// Emits a function. With a table, the largest coefficients that are not constants become elements of the
/// parameter `k` and entries of the table. Without a table they are computed like all other nodes.
[[nodiscard]] EmittedFunction emit_function(const FunctionSpec& spec,
                                            CoefficientTable* coefficients = nullptr);

/// The shortest decimal text that reads back as the same double, always with a decimal point or an exponent.
[[nodiscard]] std::string number_text(double value);

}  // namespace stilt::codegen
