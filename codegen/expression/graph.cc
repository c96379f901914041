#include "codegen/expression/graph.h"

#include <cmath>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace stilt::codegen {

Expression Graph::intern(Operation operation, int left, int right) {
  const auto [entry, inserted] = index_.try_emplace({operation, left, right}, size());
  if (inserted) {
    const bool coefficient = node(left).coefficient && (right < 0 || node(right).coefficient);
    nodes_.push_back({.operation = operation,
                      .left = left,
                      .right = right,
                      .value = 0.0,
                      .name = {},
                      .coefficient = coefficient});
  }
  return {this, entry->second};
}

Expression Graph::constant(double value) {
  if (!std::isfinite(value)) throw std::invalid_argument("an expression has a constant that is not finite");
  const double canonical = value == 0.0 ? 0.0 : value;  // a single zero, without sign
  const auto [entry, inserted] = constants_.try_emplace(canonical, size());
  if (inserted) {
    nodes_.push_back({.operation = Operation::constant,
                      .left = -1,
                      .right = -1,
                      .value = canonical,
                      .name = {},
                      .coefficient = true});
  }
  return {this, entry->second};
}

Expression Graph::symbol(const std::string& name) {
  const auto [entry, inserted] = symbols_.try_emplace(name, size());
  if (inserted) {
    nodes_.push_back({.operation = Operation::symbol,
                      .left = -1,
                      .right = -1,
                      .value = 0.0,
                      .name = name,
                      .coefficient = false});
  }
  return {this, entry->second};
}

Expression Graph::parameter(const std::string& name) {
  const Expression result = symbol(name);
  nodes_[static_cast<std::size_t>(result.id())].coefficient = true;
  return result;
}

bool Graph::is_constant(Expression a) const { return node(a.id()).operation == Operation::constant; }

bool Graph::is_constant(Expression a, double value) const {
  return is_constant(a) && node(a.id()).value == value;
}

bool Graph::is_coefficient(Expression a) const { return node(a.id()).coefficient; }

bool Graph::is_negation(Expression a) const { return node(a.id()).operation == Operation::negate; }

Expression Graph::operand(Expression a) const { return {const_cast<Graph*>(this), node(a.id()).left}; }

bool Graph::precedes(Expression a, Expression b) const {
  const auto rank = [this](Expression e) { return std::tuple(!is_constant(e), !is_coefficient(e), e.id()); };
  return rank(a) < rank(b);
}

Graph::Scaled Graph::split(Expression a) {
  const Node n = node(a.id());
  if (n.operation == Operation::multiply && !n.coefficient && node(n.left).coefficient) {
    return {{this, n.left}, {this, n.right}};
  }
  return {constant(1.0), a};
}

Expression Graph::add(Expression a, Expression b) {
  if (is_constant(a) && is_constant(b)) return constant(node(a.id()).value + node(b.id()).value);
  if (is_constant(a, 0.0)) return b;
  if (is_constant(b, 0.0)) return a;
  if (is_negation(a) && is_negation(b)) return negate(add(operand(a), operand(b)));
  if (is_negation(b)) return subtract(a, operand(b));
  if (is_negation(a)) return subtract(b, operand(a));
  if (const Scaled l = split(a), r = split(b); l.rest == r.rest) {
    return multiply(add(l.factor, r.factor), l.rest);
  }
  if (precedes(b, a)) std::swap(a, b);
  return intern(Operation::add, a.id(), b.id());
}

Expression Graph::subtract(Expression a, Expression b) {
  if (a == b) return constant(0.0);
  if (is_constant(b)) return add(a, constant(-node(b.id()).value));
  if (is_constant(a, 0.0)) return negate(b);
  if (is_negation(b)) return add(a, operand(b));
  if (is_negation(a)) return negate(add(operand(a), b));
  if (const Scaled l = split(a), r = split(b); l.rest == r.rest) {
    return multiply(subtract(l.factor, r.factor), l.rest);
  }
  const bool both_exist = is_coefficient(a) != is_coefficient(b);
  if (!both_exist && b.id() < a.id()) return negate(intern(Operation::subtract, b.id(), a.id()));
  return intern(Operation::subtract, a.id(), b.id());
}

Expression Graph::multiply(Expression a, Expression b) {
  if (is_constant(a) && is_constant(b)) return constant(node(a.id()).value * node(b.id()).value);
  if (is_constant(b)) std::swap(a, b);
  if (is_constant(a, 0.0)) return a;
  if (is_constant(a, 1.0)) return b;
  if (is_constant(a) && node(a.id()).value < 0.0) {
    return negate(multiply(constant(-node(a.id()).value), b));
  }
  if (is_negation(a)) return negate(multiply(operand(a), b));
  if (is_negation(b)) return negate(multiply(a, operand(b)));
  if (precedes(b, a)) std::swap(a, b);
  if (const Scaled right = split(b); is_coefficient(a) && !(right.rest == b)) {
    return multiply(multiply(a, right.factor), right.rest);
  }
  return intern(Operation::multiply, a.id(), b.id());
}

Expression Graph::divide(Expression a, Expression b) {
  if (is_constant(b)) {
    if (node(b.id()).value == 0.0) throw std::domain_error("an expression divides by zero");
    return multiply(constant(1.0 / node(b.id()).value), a);
  }
  if (is_constant(a, 0.0)) return a;
  if (is_coefficient(b) && !is_coefficient(a)) return multiply(divide(constant(1.0), b), a);
  if (a == b) return constant(1.0);
  if (is_negation(a)) return negate(divide(operand(a), b));
  if (is_negation(b)) return negate(divide(a, operand(b)));
  return intern(Operation::divide, a.id(), b.id());
}

Expression Graph::negate(Expression a) {
  if (is_constant(a)) return constant(-node(a.id()).value);
  if (is_negation(a)) return operand(a);
  return intern(Operation::negate, a.id(), -1);
}

Expression Graph::sine(Expression a) {
  if (is_constant(a)) return constant(std::sin(node(a.id()).value));
  if (is_negation(a)) return negate(sine(operand(a)));
  return intern(Operation::sine, a.id(), -1);
}

Expression Graph::cosine(Expression a) {
  if (is_constant(a)) return constant(std::cos(node(a.id()).value));
  if (is_negation(a)) return cosine(operand(a));
  return intern(Operation::cosine, a.id(), -1);
}

double Graph::evaluate(Expression a, const std::map<std::string, double>& symbols) const {
  std::vector<double> values(static_cast<std::size_t>(a.id()) + 1, 0.0);
  const auto value = [&values](int id) { return id < 0 ? 0.0 : values[static_cast<std::size_t>(id)]; };
  for (int id = 0; id <= a.id(); ++id) {
    const Node& n = node(id);
    const double l = value(n.left);
    const double r = value(n.right);
    double& result = values[static_cast<std::size_t>(id)];
    switch (n.operation) {
      case Operation::constant:
        result = n.value;
        break;
      case Operation::symbol:
        if (const auto entry = symbols.find(n.name); entry != symbols.end()) result = entry->second;
        break;
      case Operation::add:
        result = l + r;
        break;
      case Operation::subtract:
        result = l - r;
        break;
      case Operation::multiply:
        result = l * r;
        break;
      case Operation::divide:
        result = l / r;
        break;
      case Operation::negate:
        result = -l;
        break;
      case Operation::sine:
        result = std::sin(l);
        break;
      case Operation::cosine:
        result = std::cos(l);
        break;
    }
  }
  return values.back();
}

Expression operator+(Expression a, Expression b) { return a.graph().add(a, b); }
Expression operator-(Expression a, Expression b) { return a.graph().subtract(a, b); }
Expression operator*(Expression a, Expression b) { return a.graph().multiply(a, b); }
Expression operator/(Expression a, Expression b) { return a.graph().divide(a, b); }
Expression operator-(Expression a) { return a.graph().negate(a); }
Expression operator*(double a, Expression b) { return b.graph().constant(a) * b; }

Expression& Expression::operator+=(const Expression& other) { return *this = *this + other; }
Expression& Expression::operator-=(const Expression& other) { return *this = *this - other; }

}  // namespace stilt::codegen
