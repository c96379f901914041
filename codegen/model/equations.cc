#include "codegen/model/equations.h"

#include <cstddef>
#include <utility>

namespace stilt::codegen {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// T(r): derivative of a body-fixed vector by the angle of its link.
PlanarExpression tangent(const PlanarExpression& r) { return {r.z, -r.x}; }

Expression dot(const PlanarExpression& a, const PlanarExpression& b) { return a.x * b.x + a.z * b.z; }

PlanarExpression operator+(const PlanarExpression& a, const PlanarExpression& b) {
  return {a.x + b.x, a.z + b.z};
}
PlanarExpression operator-(const PlanarExpression& a, const PlanarExpression& b) {
  return {a.x - b.x, a.z - b.z};
}
PlanarExpression operator*(const Expression& a, const PlanarExpression& b) { return {a * b.x, a * b.z}; }

}  // namespace

TreeNumbers constant_numbers(Graph& graph, const PlanarTree& tree) {
  const auto vector = [&](PlanarVector v) {
    return PlanarExpression{graph.constant(v.x), graph.constant(v.z)};
  };
  TreeNumbers numbers;
  for (const PlanarLink& link : tree.links) {
    numbers.links.push_back({.mass_kg = graph.constant(link.mass_kg),
                             .com_m = vector(link.com_m),
                             .inertia_kg_m2 = graph.constant(link.inertia_kg_m2),
                             .origin_m = vector(link.joint.origin_m),
                             .angle_offset_rad = graph.constant(link.joint.angle_offset_rad)});
  }
  for (const PlanarFoot& foot : tree.feet) numbers.feet_m.push_back(vector(foot.position_m));
  return numbers;
}

Equations::Equations(Graph& graph, const PlanarTree& tree)
    : Equations(graph, tree, constant_numbers(graph, tree)) {}

Equations::Equations(Graph& graph, const PlanarTree& shape, TreeNumbers numbers)
    : graph_(graph), tree_(shape), numbers_(std::move(numbers)) {
  Row joints;
  Row joint_rates;
  for (int j = 0; j < tree_.joint_count(); ++j) {
    joints.push_back(position(3 + j));
    joint_rates.push_back(velocity(3 + j));
  }
  angle_ = chain_sums(position(2), joints);
  rate_ = chain_sums(velocity(2), joint_rates);
  const Expression zero = graph.constant(0.0);
  augmented_moment_.assign(tree_.links.size(), {zero, zero});
  augmented_inertia_.assign(tree_.links.size(), zero);
  Row subtree_mass(tree_.links.size(), zero);
  mass_ = zero;
  for (const TreeNumbers::Link& link : numbers_.links) mass_ += link.mass_kg;
  for (int k = tree_.link_count() - 1; k >= 0; --k) {
    const TreeNumbers::Link& link = numbers_.links[at(k)];
    PlanarExpression& moment = augmented_moment_[at(k)];
    const auto attach = [&](const Expression& mass, const PlanarExpression& r) {
      moment = moment + mass * r;
      augmented_inertia_[at(k)] += mass * (r.x * r.x + r.z * r.z);
    };
    attach(link.mass_kg, link.com_m);
    augmented_inertia_[at(k)] += link.inertia_kg_m2;
    subtree_mass[at(k)] += link.mass_kg;
    for (int c = k + 1; c < tree_.link_count(); ++c) {
      if (tree_.links[at(c)].parent == k) attach(subtree_mass[at(c)], numbers_.links[at(c)].origin_m);
    }
    const int parent = tree_.links[at(k)].parent;
    if (parent >= 0) subtree_mass[at(parent)] += subtree_mass[at(k)];
  }
  for (int k = 0; k < tree_.link_count(); ++k) {
    Expression offset = zero;
    for (const int i : tree_.path_to(k)) offset += numbers_.links[at(i)].angle_offset_rad;
    angle_[at(k)] += offset;
    sine_.push_back(graph.sine(angle_[at(k)]));
    cosine_.push_back(graph.cosine(angle_[at(k)]));
  }
}

Expression Equations::position(int index) const { return graph_.symbol("x[" + std::to_string(index) + "]"); }

Expression Equations::velocity(int index) const { return position(tree_.position_count() + index); }

Expression Equations::input(int index) const { return graph_.symbol("u[" + std::to_string(index) + "]"); }

Expression Equations::armature(int joint) const {
  return graph_.symbol("joint_parameters[" + std::to_string(joint) + "]");
}

Expression Equations::damping(int joint) const { return armature(tree_.joint_count() + joint); }

Row Equations::chain_sums(Expression root, const Row& joints) const {
  Row sums{root};
  for (int k = 1; k < tree_.link_count(); ++k) {
    const PlanarLink& link = tree_.links[at(k)];
    sums.push_back(sums[at(link.parent)] + link.joint.direction * joints[at(k - 1)]);
  }
  return sums;
}

Row Equations::subtree_sums(const Row& by_link) const {
  Row sums = by_link;
  for (int k = tree_.link_count() - 1; k > 0; --k) sums[at(tree_.links[at(k)].parent)] += sums[at(k)];
  for (int k = 1; k < tree_.link_count(); ++k) sums[at(k)] = tree_.links[at(k)].joint.direction * sums[at(k)];
  return sums;
}

Matrix Equations::jacobian(const Row& rows, const Row& variables, Differentiator& differentiate) const {
  Matrix result;
  for (const Expression& row : rows) {
    Row by_link;
    for (const Expression& variable : variables) by_link.push_back(differentiate(row, variable));
    result.push_back(subtree_sums(by_link));
  }
  return result;
}

PlanarExpression Equations::rotate(int link, const PlanarExpression& v) const {
  const Expression s = sine_[at(link)];
  const Expression c = cosine_[at(link)];
  return {v.x * c + v.z * s, v.z * c - v.x * s};
}

/// alpha T(r) - omega^2 r: acceleration of the tip of the body-fixed vector r relative to its foot.
PlanarExpression Equations::turn(int link, const PlanarExpression& v, const AbsoluteMotion& motion) const {
  const PlanarExpression r = rotate(link, v);
  const Expression rate = motion.rate[at(link)];
  return motion.acceleration[at(link)] * tangent(r) - (rate * rate) * r;
}

std::vector<PlanarExpression> Equations::origin_accelerations(const AbsoluteMotion& motion) const {
  std::vector<PlanarExpression> result{motion.base_acceleration};
  for (int k = 1; k < tree_.link_count(); ++k) {
    const int parent = tree_.links[at(k)].parent;
    result.push_back(result[at(parent)] + turn(parent, numbers_.links[at(k)].origin_m, motion));
  }
  return result;
}

EquationRows Equations::equations(const AbsoluteMotion& motion) const {
  const std::vector<PlanarExpression> origin = origin_accelerations(motion);
  const Expression zero = graph_.constant(0.0);
  const std::size_t links = tree_.links.size();
  std::vector<PlanarExpression> net_force(links, {zero, zero});
  Row moment(links, zero);
  for (int k = tree_.link_count() - 1; k >= 0; --k) {
    const PlanarLink& link = tree_.links[at(k)];
    const PlanarExpression& d = augmented_moment_[at(k)];
    moment[at(k)] +=
        augmented_inertia_[at(k)] * motion.acceleration[at(k)] + dot(tangent(rotate(k, d)), origin[at(k)]);
    net_force[at(k)] = turn(k, d, motion) + net_force[at(k)];
    for (int f = 0; f < tree_.foot_count(); ++f) {
      if (tree_.feet[at(f)].link != k) continue;
      const PlanarExpression arm = tangent(rotate(k, numbers_.feet_m[at(f)]));
      moment[at(k)] -= dot(arm, motion.force[at(f)]);
      net_force[at(k)] = net_force[at(k)] - motion.force[at(f)];
    }
    if (link.parent < 0) continue;
    moment[at(link.parent)] +=
        dot(tangent(rotate(link.parent, numbers_.links[at(k)].origin_m)), net_force[at(k)]);
    net_force[at(link.parent)] = net_force[at(link.parent)] + net_force[at(k)];
  }
  EquationRows result;
  result.row.push_back(mass_ * motion.base_acceleration.x + net_force[0].x);
  result.row.push_back(mass_ * motion.base_acceleration.z + net_force[0].z);
  for (const Expression& row : subtree_sums(moment)) result.row.push_back(row);
  return result;
}

Matrix Equations::mass_matrix() const {
  AbsoluteMotion motion;
  const Expression zero = graph_.constant(0.0);
  motion.base_acceleration = {graph_.symbol("probe_x"), graph_.symbol("probe_z")};
  motion.rate.assign(tree_.links.size(), zero);
  motion.force.assign(tree_.feet.size(), {zero, zero});
  for (int k = 0; k < tree_.link_count(); ++k) {
    motion.acceleration.push_back(graph_.symbol("probe_" + std::to_string(k)));
  }
  Row variables{motion.base_acceleration.x, motion.base_acceleration.z};
  variables.insert(variables.end(), motion.acceleration.begin(), motion.acceleration.end());
  Differentiator differentiate(variables);
  const EquationRows equation = equations(motion);
  Matrix result = jacobian(equation.row, motion.acceleration, differentiate);
  for (std::size_t i = 0; i < result.size(); ++i) {
    const Row linear{differentiate(equation.row[i], variables[0]),
                     differentiate(equation.row[i], variables[1])};
    result[i].insert(result[i].begin(), linear.begin(), linear.end());
  }
  for (std::size_t i = 0; i < result.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) result[i][j] = result[j][i];
  }
  return result;
}

PlanarExpression Equations::foot_position(int foot) const {
  const PlanarFoot& f = tree_.feet[at(foot)];
  PlanarExpression relative = rotate(f.link, numbers_.feet_m[at(foot)]);
  for (int k = f.link; k > 0; k = tree_.links[at(k)].parent) {
    relative = rotate(tree_.links[at(k)].parent, numbers_.links[at(k)].origin_m) + relative;
  }
  return PlanarExpression{position(0), position(1)} + relative;
}

PlanarExpression Equations::foot_velocity(int foot) const {
  const PlanarFoot& f = tree_.feet[at(foot)];
  PlanarExpression v{velocity(0), velocity(1)};
  const std::vector<int> path = tree_.path_to(f.link);
  for (std::size_t i = 0; i < path.size(); ++i) {
    const bool last = i + 1 == path.size();
    const PlanarExpression& arm = last ? numbers_.feet_m[at(foot)] : numbers_.links[at(path[i + 1])].origin_m;
    v = v + rate_[at(path[i])] * tangent(rotate(path[i], arm));
  }
  return v;
}

PlanarExpression Equations::foot_acceleration(int foot, const AbsoluteMotion& motion) const {
  const PlanarFoot& f = tree_.feet[at(foot)];
  PlanarExpression a =
      origin_accelerations(motion)[at(f.link)] + turn(f.link, numbers_.feet_m[at(foot)], motion);
  a.z -= graph_.constant(kGravity_m_s2);
  return a;
}

Matrix Equations::foot_jacobian(int foot) const {
  Differentiator differentiate(angle_);
  const PlanarExpression p = foot_position(foot);
  Matrix result = jacobian({p.x, p.z}, angle_, differentiate);
  for (std::size_t i = 0; i < 2; ++i) {
    const Row linear{graph_.constant(i == 0 ? 1.0 : 0.0), graph_.constant(i == 1 ? 1.0 : 0.0)};
    result[i].insert(result[i].begin(), linear.begin(), linear.end());
  }
  return result;
}

}  // namespace stilt::codegen
