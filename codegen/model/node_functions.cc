#include <array>
#include <cstddef>

#include "codegen/model/functions.h"

namespace stilt::codegen {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

using BaseColumn = std::array<Expression, 3>;  ///< x, z, pitch

/// Solves M_bb y = r. The base block of the mass matrix is [m 0 a; 0 m b; a b I]. Eliminating the two linear
/// rows leaves one equation for the pitch.
class BaseSolver {
 public:
  explicit BaseSolver(const Matrix& mass) {
    Graph& graph = mass[0][0].graph();
    inverse_mass_ = graph.constant(1.0) / mass[0][0];
    offset_ = {inverse_mass_ * mass[0][2], inverse_mass_ * mass[1][2]};
    inverse_ = graph.constant(1.0) / (mass[2][2] - (mass[0][2] * offset_.x + mass[1][2] * offset_.z));
    scaled_ = {inverse_ * offset_.x, inverse_ * offset_.z};
  }

  [[nodiscard]] BaseColumn solve(const BaseColumn& r) const {
    const Expression pitch = inverse_ * r[2] - scaled_.x * r[0] - scaled_.z * r[1];
    return {inverse_mass_ * r[0] - offset_.x * pitch, inverse_mass_ * r[1] - offset_.z * pitch, pitch};
  }

 private:
  Expression inverse_mass_;
  PlanarExpression offset_;
  Expression inverse_;
  PlanarExpression scaled_;
};

/// One node of the reparametrised dynamics. Inputs are joint accelerations a and contact forces f; the base
/// rows give the base acceleration, the joint rows the motor torques.
class NodeModel {
 public:
  explicit NodeModel(const Equations& equations)
      : equations_(equations),
        graph_(equations.graph()),
        joints_(equations.tree().joint_count()),
        feet_(equations.tree().foot_count()),
        mass_(equations.mass_matrix()),
        solver_(mass_) {
    for (int f = 0; f < feet_; ++f) {
      for (const Row& row : equations.foot_jacobian(f)) jacobian_.push_back(row);
    }
    solve_motion();
    for (int f = 0; f < feet_; ++f) {
      const PlanarExpression a = equations.foot_acceleration(f, motion_);
      foot_acceleration_.insert(foot_acceleration_.end(), {a.x, a.z});
    }
    for (int j = 0; j < joints_; ++j) {
      joint_torque_.push_back(rows_.row[at(3 + j)] + equations.armature(j) * equations.input(j) +
                              equations.damping(j) * equations.velocity(3 + j));
    }
  }

  void append_base_acceleration(std::vector<Output>& out) const {
    append(out, "base_acceleration", Row(base_acceleration_.begin(), base_acceleration_.end()));
  }

  void append_feet_and_torque(std::vector<Output>& out) const {
    Row position;
    Row velocity;
    for (int f = 0; f < feet_; ++f) {
      const PlanarExpression p = equations_.foot_position(f);
      const PlanarExpression v = equations_.foot_velocity(f);
      position.insert(position.end(), {p.x, p.z});
      velocity.insert(velocity.end(), {v.x, v.z});
    }
    append(out, "foot_position", position);
    append(out, "foot_velocity", velocity);
    append(out, "foot_acceleration", foot_acceleration_);
    append(out, "joint_torque", joint_torque_);
  }

  /// d foot position and d foot velocity by the angles of each foot's own chain.
  void append_foot_chains(std::vector<Output>& out) const {
    Differentiator differentiate(equations_.angles());
    for (int f = 0; f < feet_; ++f) {
      const std::vector<int> chain = equations_.tree().path_to(equations_.tree().feet[at(f)].link);
      const PlanarExpression v = equations_.foot_velocity(f);
      const Matrix velocity = equations_.jacobian({v.x, v.z}, equations_.angles(), differentiate);
      for (int axis = 0; axis < 2; ++axis) {
        for (std::size_t i = 0; i < chain.size(); ++i) {
          const int row = 2 * f + axis;
          const int column = static_cast<int>(i);
          out.push_back({element("foot_position_dchain", row, column), jacobian_[at(row)][at(2 + chain[i])]});
          out.push_back({element("foot_velocity_dchain", row, column), velocity[at(axis)][at(chain[i])]});
        }
      }
    }
  }

  /// Columns by theta ("_dtheta", variables: absolute angles) or omega ("_domega", absolute rates). `full`
  /// adds foot acceleration and joint torque.
  void append_state_columns(std::vector<Output>& out, const std::string& suffix, const Row& variables,
                            bool full) const {
    Row cuts = equations_.angles();
    cuts.insert(cuts.end(), motion_.rate.begin(), motion_.rate.end());
    cuts.insert(cuts.end(), motion_.acceleration.begin(), motion_.acceleration.end());
    cuts.insert(cuts.end(), {motion_.base_acceleration.x, motion_.base_acceleration.z});
    Differentiator differentiate(cuts);
    const Matrix partial = equations_.jacobian(rows_.row, variables, differentiate);
    const Matrix foot_partial = equations_.jacobian(foot_acceleration_, variables, differentiate);
    for (int i = 0; i < equations_.tree().link_count(); ++i) {
      const BaseColumn base = solver_.solve({-partial[0][at(i)], -partial[1][at(i)], -partial[2][at(i)]});
      append_base_column(out, "base_acceleration" + suffix, i, base);
      if (!full) continue;
      for (int r = 0; r < 2 * feet_; ++r) {
        out.push_back({element("foot_acceleration" + suffix, r, i),
                       foot_partial[at(r)][at(i)] + along_base(jacobian_[at(r)], base)});
      }
      for (int j = 0; j < joints_; ++j) {
        Expression torque = partial[at(3 + j)][at(i)] + along_base(mass_[at(3 + j)], base);
        if (variables == motion_.rate && i == j + 1) torque += equations_.damping(j);
        out.push_back({element("joint_torque" + suffix, j, i), torque});
      }
    }
  }

  /// Columns by the input. With Y = M_bb^-1 M_bj and Z = M_bb^-1 J_b', the full matrix is
  ///   base acceleration [-Y, Z];  foot acceleration [J_j - J_b Y, J_b Z];
  ///   joint torque [M_jj - M_jb Y + armature, -(J_j - J_b Y)'].
  /// Only one triangle of each symmetric block and one of the two mixed blocks are therefore computed.
  void append_input_columns(std::vector<Output>& out, bool full) const {
    const std::string foot = "foot_acceleration_du";
    const std::string torque = "joint_torque_du";
    for (int j = 0; j < joints_; ++j) {
      const BaseColumn base = acceleration_column(j);
      append_base_column(out, "base_acceleration_du", j, base);
      if (!full) continue;
      for (int r = 0; r < 2 * feet_; ++r) {
        const Expression mixed = jacobian_[at(r)][at(3 + j)] + along_base(jacobian_[at(r)], base);
        out.push_back({element(foot, r, j), mixed});
        out.push_back({element(torque, j, joints_ + r), -mixed});
      }
      for (int i = 0; i <= j; ++i) {
        Expression value = mass_[at(3 + i)][at(3 + j)] + along_base(mass_[at(3 + i)], base);
        if (i == j) value += equations_.armature(j);
        append_symmetric(out, torque, i, j, 0, value);
      }
    }
    for (int c = 0; c < 2 * feet_; ++c) {
      const BaseColumn base = force_column(c);
      append_base_column(out, "base_acceleration_du", joints_ + c, base);
      if (!full) continue;
      for (int r = 0; r <= c; ++r)
        append_symmetric(out, foot, r, c, joints_, along_base(jacobian_[at(r)], base));
    }
  }

  [[nodiscard]] const Row& rates() const { return motion_.rate; }

 private:
  void solve_motion() {
    const Expression zero = graph_.constant(0.0);
    Row joint_accelerations;
    for (int j = 0; j < joints_; ++j) joint_accelerations.push_back(equations_.input(j));
    motion_.rate = equations_.rates();
    motion_.base_acceleration = {zero, graph_.constant(kGravity_m_s2)};
    motion_.acceleration = equations_.chain_sums(zero, joint_accelerations);
    for (int f = 0; f < feet_; ++f) {
      motion_.force.push_back({equations_.input(joints_ + 2 * f), equations_.input(joints_ + 2 * f + 1)});
    }
    const EquationRows held = equations_.equations(motion_);  // for a base at rest
    base_acceleration_ = solver_.solve({-held.row[0], -held.row[1], -held.row[2]});
    motion_.base_acceleration.x += base_acceleration_[0];
    motion_.base_acceleration.z += base_acceleration_[1];
    for (Expression& acceleration : motion_.acceleration) acceleration += base_acceleration_[2];
    rows_ = equations_.equations(motion_);
  }

  [[nodiscard]] BaseColumn acceleration_column(int joint) const {
    const std::size_t c = at(3 + joint);
    return solver_.solve({-mass_[0][c], -mass_[1][c], -mass_[2][c]});
  }

  [[nodiscard]] BaseColumn force_column(int row) const {
    const Row& j = jacobian_[at(row)];
    return solver_.solve({j[0], j[1], j[2]});
  }

  /// Product of a row's base part with a column of the base acceleration.
  static Expression along_base(const Row& row, const BaseColumn& base) {
    return row[0] * base[0] + row[1] * base[1] + row[2] * base[2];
  }

  static void append_base_column(std::vector<Output>& out, const std::string& name, int column,
                                 const BaseColumn& base) {
    for (int r = 0; r < 3; ++r) out.push_back({element(name, r, column), base[at(r)]});
  }

  static void append_symmetric(std::vector<Output>& out, const std::string& name, int i, int j,
                               int first_column, Expression value) {
    out.push_back({element(name, i, first_column + j), value});
    if (i != j) out.push_back({element(name, j, first_column + i), value});
  }

  const Equations& equations_;
  Graph& graph_;
  int joints_;
  int feet_;
  Matrix mass_;
  BaseSolver solver_;
  Matrix jacobian_;
  AbsoluteMotion motion_;
  EquationRows rows_;
  BaseColumn base_acceleration_;
  Row foot_acceleration_;
  Row joint_torque_;
};

constexpr const char* kInputText =
    "u: joint accelerations (rad/s^2), then contact forces fx, fz of each foot (N, world frame, on the "
    "robot).";

FunctionSpec flow(const NodeModel& model, bool derivatives) {
  FunctionSpec spec{
      .name = derivatives ? "flow_derivatives" : "flow",
      .documentation = std::string("Acceleration of the base [x, z, pitch] that solves the base rows "
                                   "of the equations of motion.\n") +
                       kInputText,
      .parameters = {"x", "u"},
      .outputs = {}};
  model.append_base_acceleration(spec.outputs);
  return spec;
}

FunctionSpec node(const NodeModel& model, bool derivatives) {
  FunctionSpec spec{
      .name = derivatives ? "node_derivatives" : "node",
      .documentation = std::string("Base acceleration, feet (position, velocity, acceleration; world "
                                   "frame) and motor torques of one node.\n") +
                       kInputText +
                       "\njoint_parameters: armature of each joint (kg m^2), then damping of each "
                       "joint (Nm s/rad).\nMotor torque = joint row of M a + bias - J' f + armature a "
                       "+ damping v.",
      .parameters = {"x", "u", "joint_parameters"},
      .outputs = {}};
  model.append_base_acceleration(spec.outputs);
  model.append_feet_and_torque(spec.outputs);
  return spec;
}

void append_derivatives(FunctionSpec& spec, const NodeModel& model, const Equations& equations, bool full) {
  spec.documentation +=
      "\nDerivatives: _dtheta and _domega by [pitch, joints] and their rates, _du by the input" +
      std::string(full ? ",\n_dchain by pitch and the joints on the way to the foot." : ".");
  if (full) model.append_foot_chains(spec.outputs);
  model.append_state_columns(spec.outputs, "_dtheta", equations.angles(), full);
  model.append_state_columns(spec.outputs, "_domega", model.rates(), full);
  model.append_input_columns(spec.outputs, full);
}

}  // namespace

std::vector<FunctionSpec> node_functions(const Equations& equations) {
  const NodeModel model(equations);
  std::vector<FunctionSpec> specs{flow(model, false), flow(model, true), node(model, false),
                                  node(model, true)};
  append_derivatives(specs[1], model, equations, false);
  append_derivatives(specs[3], model, equations, true);
  return specs;
}

}  // namespace stilt::codegen
