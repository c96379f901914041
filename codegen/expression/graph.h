#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <tuple>
#include <vector>

namespace stilt::codegen {

class Graph;

/// Operation of a node. Subtraction and negation are separate, so that signs can move outwards.
enum class Operation { constant, symbol, add, subtract, multiply, divide, negate, sine, cosine };

/// Handle of one node of a Graph. Copies are cheap; two equal expressions of a graph are the same node. A
/// default-constructed handle belongs to no graph and may only be assigned to.
class Expression {
 public:
  Expression() = default;
  Expression(Graph* graph, int id) : graph_(graph), id_(id) {}

  [[nodiscard]] Graph& graph() const { return *graph_; }
  [[nodiscard]] int id() const { return id_; }
  [[nodiscard]] bool operator==(const Expression& other) const {
    return graph_ == other.graph_ && id_ == other.id_;
  }

  Expression& operator+=(const Expression& other);
  Expression& operator-=(const Expression& other);

 private:
  Graph* graph_ = nullptr;
  int id_ = -1;
};

/// One node: an operation and the ids of its operands (-1 where unused).
struct Node {
  Operation operation;
  int left = -1;
  int right = -1;
  double value = 0.0;        ///< of a constant
  std::string name;          ///< of a symbol, as the emitted code spells it
  bool coefficient = false;  ///< computed from constants and parameters only
};

// clang-format off
/// Hash-consed expression graph: building an expression that exists already returns the existing node, so
/// that every equal subexpression is computed once.
///
/// Canonical form, established while building:
///  - constants are folded; x + 0, x * 1, x * 0, x / 1, x - x vanish; division by a coefficient multiplies;
///  - operands of + and * are in order of creation, a constant first, then a coefficient;
///  - coefficients are joined: c1 (c2 x) = (c1 c2) x, c1 x + c2 x = (c1 + c2) x;
///  - constant factors are positive: (-c) x = -(c x);
///  - negations move outwards through * and /, and turn + into - and back. Of a - b and b - a only the one
///    whose first operand is older exists, the other is its negation.
///
/// A coefficient is a constant, a parameter, or an expression of these alone: a number that a caller can
/// compute once for many evaluations. Ids grow from operands to results:
/// ascending order is an order of evaluation.
// clang-format on
class Graph {
 public:
  [[nodiscard]] Expression constant(double value);
  [[nodiscard]] Expression symbol(const std::string& name);
  /// A symbol whose value is the same for many evaluations.
  [[nodiscard]] Expression parameter(const std::string& name);
  [[nodiscard]] Expression add(Expression a, Expression b);
  [[nodiscard]] Expression subtract(Expression a, Expression b);
  [[nodiscard]] Expression multiply(Expression a, Expression b);
  [[nodiscard]] Expression divide(Expression a, Expression b);
  [[nodiscard]] Expression negate(Expression a);
  [[nodiscard]] Expression sine(Expression a);
  [[nodiscard]] Expression cosine(Expression a);

  [[nodiscard]] const Node& node(int id) const { return nodes_[static_cast<std::size_t>(id)]; }
  [[nodiscard]] int size() const { return static_cast<int>(nodes_.size()); }
  [[nodiscard]] bool is_constant(Expression a) const;
  [[nodiscard]] bool is_constant(Expression a, double value) const;
  [[nodiscard]] bool is_coefficient(Expression a) const;

  /// Value of an expression for given values of the symbols; for tests.
  [[nodiscard]] double evaluate(Expression a, const std::map<std::string, double>& symbols) const;

 private:
  [[nodiscard]] Expression intern(Operation operation, int left, int right);
  [[nodiscard]] bool is_negation(Expression a) const;
  [[nodiscard]] Expression operand(Expression a) const;

  /// Whether a precedes b in the canonical order of sums and products.
  [[nodiscard]] bool precedes(Expression a, Expression b) const;

  /// factor * rest; the factor is one unless the expression is a product with a coefficient.
  struct Scaled {
    Expression factor;
    Expression rest;
  };
  [[nodiscard]] Scaled split(Expression a);

  std::vector<Node> nodes_;
  std::map<std::tuple<Operation, int, int>, int> index_;
  std::map<double, int> constants_;
  std::map<std::string, int> symbols_;
};

[[nodiscard]] Expression operator+(Expression a, Expression b);
[[nodiscard]] Expression operator-(Expression a, Expression b);
[[nodiscard]] Expression operator*(Expression a, Expression b);
[[nodiscard]] Expression operator/(Expression a, Expression b);
[[nodiscard]] Expression operator-(Expression a);
[[nodiscard]] Expression operator*(double a, Expression b);

}  // namespace stilt::codegen
