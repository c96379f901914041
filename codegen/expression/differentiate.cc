#include "codegen/expression/differentiate.h"

#include <stdexcept>

namespace stilt::codegen {
namespace {

/// variable = factor * node, where node is neither a negation nor a product with a coefficient.
struct Cut {
  Expression node;
  Expression factor;
};

Cut cut_of(Expression variable) {
  Graph& graph = variable.graph();
  Cut cut{.node = variable, .factor = graph.constant(1.0)};
  while (true) {
    const Node n = graph.node(cut.node.id());  // a copy: making a factor may reallocate the nodes
    if (n.coefficient) throw std::invalid_argument("differentiation by an expression that is a constant");
    if (n.operation == Operation::negate) {
      cut = {.node = {&graph, n.left}, .factor = -cut.factor};
    } else if (n.operation == Operation::multiply && graph.is_coefficient({&graph, n.left})) {
      cut = {.node = {&graph, n.right}, .factor = cut.factor * Expression(&graph, n.left)};
    } else {
      return cut;
    }
  }
}

}  // namespace

Differentiator::Differentiator(std::span<const Expression> variables) {
  for (const Expression& variable : variables) variables_.insert(cut_of(variable).node.id());
}

Expression Differentiator::operator()(Expression expression, Expression variable) {
  const Cut cut = cut_of(variable);
  if (!variables_.contains(cut.node.id())) {
    throw std::invalid_argument("differentiation by an expression that is not among the variables");
  }
  return derive(expression, cut.node) / cut.factor;
}

Expression Differentiator::derive(Expression e, Expression variable) {
  Graph& graph = e.graph();
  if (e == variable) return graph.constant(1.0);
  if (variables_.contains(e.id())) return graph.constant(0.0);
  const std::pair key{e.id(), variable.id()};
  if (const auto known = memo_.find(key); known != memo_.end()) return known->second;

  const Node n = graph.node(e.id());
  const Expression l{&graph, n.left};
  const Expression r{&graph, n.right};
  Expression result = graph.constant(0.0);
  switch (n.operation) {
    case Operation::constant:
    case Operation::symbol:
      break;
    case Operation::add:
      result = derive(l, variable) + derive(r, variable);
      break;
    case Operation::subtract:
      result = derive(l, variable) - derive(r, variable);
      break;
    case Operation::multiply:
      result = derive(l, variable) * r + l * derive(r, variable);
      break;
    case Operation::divide:
      result = (derive(l, variable) - e * derive(r, variable)) / r;
      break;
    case Operation::negate:
      result = -derive(l, variable);
      break;
    case Operation::sine:
      result = derive(l, variable) * graph.cosine(l);
      break;
    case Operation::cosine:
      result = -(derive(l, variable) * graph.sine(l));
      break;
  }
  memo_.emplace(key, result);
  return result;
}

}  // namespace stilt::codegen
