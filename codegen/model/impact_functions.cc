#include <cstddef>

#include "codegen/model/functions.h"

namespace stilt::codegen {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// M = L D L', eliminated from the last coordinate (the leaves) to the first. On a tree this order creates no
/// fill-in.
class TreeFactorisation {
 public:
  explicit TreeFactorisation(Matrix m) : factor_(std::move(m)) {
    const int n = static_cast<int>(factor_.size());
    for (int k = n - 1; k >= 0; --k) {
      inverse_.insert(inverse_.begin(), factor_[0][0].graph().constant(1.0) / factor_[at(k)][at(k)]);
      for (int i = 0; i < k; ++i) {
        const Expression scaled = factor_[at(i)][at(k)] * inverse_.front();
        for (int j = 0; j <= i; ++j) factor_[at(i)][at(j)] -= scaled * factor_[at(j)][at(k)];
        lower_.push_back(scaled);
      }
      for (int i = 0; i < k; ++i) {
        for (int j = i + 1; j < k; ++j) factor_[at(i)][at(j)] = factor_[at(j)][at(i)];
        factor_[at(k)][at(i)] = lower_[lower_.size() - at(k) + at(i)];
      }
    }
  }

  /// M^-1 r.
  [[nodiscard]] Row solve(Row r) const {
    const int n = static_cast<int>(factor_.size());
    for (int k = n - 1; k >= 0; --k) {
      for (int i = 0; i < k; ++i) r[at(i)] -= factor_[at(k)][at(i)] * r[at(k)];
    }
    for (int k = 0; k < n; ++k) {
      r[at(k)] = r[at(k)] * inverse_[at(k)];
      for (int i = 0; i < k; ++i) r[at(k)] -= factor_[at(k)][at(i)] * r[at(i)];
    }
    return r;
  }

 private:
  Matrix factor_;  ///< below the diagonal: the multipliers
  Row inverse_;    ///< of D
  Row lower_;
};

Expression inner(const Row& a, const Row& b) {
  Expression sum = a[0] * b[0];
  for (std::size_t i = 1; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// The impact of one foot: [M -J'; J 0] [v+; impulse] = [M v-; 0], with X = M^-1 J', S = J X:
/// impulse = -S^-1 J v-, v+ = v- + X impulse.
class ImpactModel {
 public:
  ImpactModel(const Equations& equations, int foot)
      : equations_(equations),
        foot_(foot),
        mass_(with_armature(equations)),
        factorisation_(mass_),
        jacobian_(equations.foot_jacobian(foot)) {
    for (const Row& row : jacobian_) response_.push_back(factorisation_.solve(row));
    xx_ = inner(jacobian_[0], response_[0]);
    xz_ = inner(jacobian_[0], response_[1]);
    zz_ = inner(jacobian_[1], response_[1]);
    inverse_determinant_ = equations.graph().constant(1.0) / (xx_ * zz_ - xz_ * xz_);
    Row before;
    for (int i = 0; i < equations.tree().position_count(); ++i) before.push_back(equations.velocity(i));
    const PlanarExpression p = solve_contact({inner(jacobian_[0], before), inner(jacobian_[1], before)});
    impulse_ = {-p.x, -p.z};
    for (std::size_t i = 0; i < before.size(); ++i) {
      jump_.push_back(response_[0][i] * impulse_.x + response_[1][i] * impulse_.z);
      after_.push_back(before[i] + jump_[i]);
    }
  }

  void append_values(std::vector<Output>& out) const {
    append(out, "velocity_after", after_);
    append(out, "impulse", Row{impulse_.x, impulse_.z});
  }

  /// d impulse / dv- = -S^-1 J, dv+ / dv- = 1 + X d impulse.
  void append_velocity_columns(std::vector<Output>& out) const {
    for (int c = 0; c < equations_.tree().position_count(); ++c) {
      const PlanarExpression p = solve_contact({jacobian_[0][at(c)], jacobian_[1][at(c)]});
      out.push_back({element("impulse_dv", 0, c), -p.x});
      out.push_back({element("impulse_dv", 1, c), -p.z});
      for (int r = 0; r < equations_.tree().position_count(); ++r) {
        const Expression own = equations_.graph().constant(r == c ? 1.0 : 0.0);
        const Expression value = own - (response_[0][at(r)] * p.x + response_[1][at(r)] * p.z);
        out.push_back({element("velocity_after_dv", r, c), value});
      }
    }
  }

  /// Differentiating both rows with v+ - v-, v+ and the impulse held: r1 = -d(M (v+ - v-) - J' impulse),
  /// r2 = -d(J v+); then d impulse = S^-1 (r2 - X' r1), dv+ = M^-1 r1 + X d impulse.
  void append_angle_columns(std::vector<Output>& out) const {
    const Matrix momentum = momentum_by_angles();
    const Matrix contact = contact_velocity_by_angles();
    for (int c = 0; c < equations_.tree().link_count(); ++c) {
      Row r1;
      for (const Row& row : momentum) r1.push_back(-row[at(c)]);
      const PlanarExpression impulse = solve_contact(
          {-contact[0][at(c)] - inner(response_[0], r1), -contact[1][at(c)] - inner(response_[1], r1)});
      out.push_back({element("impulse_dtheta", 0, c), impulse.x});
      out.push_back({element("impulse_dtheta", 1, c), impulse.z});
      const Row direct = factorisation_.solve(r1);
      for (int r = 0; r < equations_.tree().position_count(); ++r) {
        out.push_back({element("velocity_after_dtheta", r, c),
                       direct[at(r)] + response_[0][at(r)] * impulse.x + response_[1][at(r)] * impulse.z});
      }
    }
  }

 private:
  static Matrix with_armature(const Equations& equations) {
    Matrix mass = equations.mass_matrix();
    for (int j = 0; j < equations.tree().joint_count(); ++j)
      mass[at(3 + j)][at(3 + j)] += equations.armature(j);
    return mass;
  }

  /// S^-1 r.
  [[nodiscard]] PlanarExpression solve_contact(const PlanarExpression& r) const {
    return {(zz_ * r.x - xz_ * r.z) * inverse_determinant_, (xx_ * r.z - xz_ * r.x) * inverse_determinant_};
  }

  [[nodiscard]] Row absolute(const Row& relative) const {
    return equations_.chain_sums(relative[2], Row(relative.begin() + 3, relative.end()));
  }

  [[nodiscard]] Row cuts(const Row& values) const {
    Row result = equations_.angles();
    result.insert(result.end(), values.begin(), values.end());
    return result;
  }

  [[nodiscard]] Matrix momentum_by_angles() const {
    const Expression zero = equations_.graph().constant(0.0);
    AbsoluteMotion motion;
    motion.base_acceleration = {jump_[0], jump_[1]};
    motion.acceleration = absolute(jump_);
    motion.rate.assign(motion.acceleration.size(), zero);
    motion.force.assign(equations_.tree().feet.size(), {zero, zero});
    motion.force[at(foot_)] = impulse_;
    Row held = motion.acceleration;
    held.insert(held.end(), {jump_[0], jump_[1], impulse_.x, impulse_.z});
    Differentiator differentiate(cuts(held));
    return equations_.jacobian(equations_.equations(motion).row, equations_.angles(), differentiate);
  }

  [[nodiscard]] Matrix contact_velocity_by_angles() const {
    Differentiator differentiate(cuts(after_));
    Matrix result(2);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      Row row;
      for (int c = 0; c < equations_.tree().link_count(); ++c) {
        Expression sum = equations_.graph().constant(0.0);
        for (int k = 0; k < equations_.tree().link_count(); ++k) {
          const Matrix second =
              equations_.jacobian({jacobian_[axis][at(2 + k)]}, equations_.angles(), differentiate);
          sum += second[0][at(c)] * after_[at(2 + k)];
        }
        row.push_back(sum);
      }
      result[axis] = row;
    }
    return result;
  }

  const Equations& equations_;
  int foot_;
  Matrix mass_;
  TreeFactorisation factorisation_;
  Matrix jacobian_;
  Matrix response_;  ///< X', two rows
  Expression xx_, xz_, zz_;
  Expression inverse_determinant_;
  PlanarExpression impulse_;
  Row jump_;   ///< v+ - v-
  Row after_;  ///< v+
};

std::string side_name(const std::string& foot) {
  const std::string side = foot.substr(std::string("foot_").size());
  if (side == "L") return "left";
  if (side == "R") return "right";
  return side;
}

}  // namespace

std::vector<FunctionSpec> impact_functions(const Equations& equations, int foot) {
  const std::string& foot_name = equations.tree().feet[at(foot)].name;
  const std::string text =
      "Rigid impact without slip or rebound of " + foot_name +
      ": x holds q and the velocities before,\nvelocity_after those after (SI), impulse "
      "[x, z] in Ns acts on the robot; M velocity_after - J' impulse = M v,\n"
      "J velocity_after = 0. joint_parameters: armature of each joint (kg m^2) enters M.";
  const ImpactModel model(equations, foot);
  FunctionSpec values{.name = "impact_" + side_name(foot_name),
                      .documentation = text,
                      .parameters = {"x", "joint_parameters"},
                      .outputs = {}};
  model.append_values(values.outputs);
  FunctionSpec derivatives = values;
  derivatives.name += "_derivatives";
  derivatives.documentation += "\nDerivatives: _dtheta by [pitch, joints], _dv by the velocities before.";
  model.append_velocity_columns(derivatives.outputs);
  model.append_angle_columns(derivatives.outputs);
  return {values, derivatives};
}

}  // namespace stilt::codegen
