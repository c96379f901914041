#include <cstddef>
#include <optional>

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

/// S^-1 r for the small matrix of the contact: in closed form for one foot, by elimination for more.
class ContactInverse {
 public:
  explicit ContactInverse(Matrix s) : s_(std::move(s)) {
    if (s_.size() != 2) {
      factorisation_.emplace(s_);
      return;
    }
    const Expression one = s_[0][0].graph().constant(1.0);
    inverse_determinant_.push_back(one / (s_[0][0] * s_[1][1] - s_[0][1] * s_[0][1]));
  }

  [[nodiscard]] Row solve(const Row& r) const {
    if (factorisation_) return factorisation_->solve(r);
    const Expression& inverse = inverse_determinant_.front();
    return {(s_[1][1] * r[0] - s_[0][1] * r[1]) * inverse, (s_[0][0] * r[1] - s_[0][1] * r[0]) * inverse};
  }

 private:
  Matrix s_;
  Row inverse_determinant_;
  std::optional<TreeFactorisation> factorisation_;
};

/// The impact that brings feet to rest: [M -J'; J 0] [v+; impulse] = [M v-; 0], J with two rows a foot. With
/// X = M^-1 J', S = J X: impulse = -S^-1 J v-, v+ = v- + X impulse.
class ImpactModel {
 public:
  ImpactModel(const Equations& equations, std::vector<int> feet)
      : equations_(equations),
        feet_(std::move(feet)),
        factorisation_(with_armature(equations)),
        jacobian_(rows_of(equations, feet_)) {
    for (const Row& row : jacobian_) response_.push_back(factorisation_.solve(row));
    contact_.emplace(products(response_));
    Row before;
    for (int i = 0; i < equations.tree().position_count(); ++i) before.push_back(equations.velocity(i));
    impulse_ = negated(contact_->solve(products(before)));
    jump_ = combined(impulse_);
    for (std::size_t i = 0; i < before.size(); ++i) after_.push_back(before[i] + jump_[i]);
  }

  void append_values(std::vector<Output>& out) const {
    append(out, "velocity_after", after_);
    append(out, "impulse", impulse_);
  }

  /// d impulse / dv- = -S^-1 J, dv+ / dv- = 1 + X d impulse.
  void append_velocity_columns(std::vector<Output>& out) const {
    for (int c = 0; c < equations_.tree().position_count(); ++c) {
      Row column;
      for (const Row& row : jacobian_) column.push_back(row[at(c)]);
      const Row p = contact_->solve(column);
      const Row change = combined(p);
      for (std::size_t r = 0; r < p.size(); ++r)
        out.push_back({element("impulse_dv", static_cast<int>(r), c), -p[r]});
      for (int r = 0; r < equations_.tree().position_count(); ++r) {
        const Expression own = equations_.graph().constant(r == c ? 1.0 : 0.0);
        out.push_back({element("velocity_after_dv", r, c), own - change[at(r)]});
      }
    }
  }

  /// Differentiating both rows with v+ - v-, v+ and the impulse held: r1 = -d(M (v+ - v-) - J' impulse),
  /// r2 = -d(J v+). Then d impulse = S^-1 (r2 - X' r1), dv+ = M^-1 r1 + X d impulse.
  void append_angle_columns(std::vector<Output>& out) const {
    const Matrix momentum = momentum_by_angles();
    const Matrix contact = contact_velocity_by_angles();
    for (int c = 0; c < equations_.tree().link_count(); ++c) {
      Row r1;
      for (const Row& row : momentum) r1.push_back(-row[at(c)]);
      Row right;
      for (std::size_t i = 0; i < response_.size(); ++i)
        right.push_back(-contact[i][at(c)] - inner(response_[i], r1));
      const Row impulse = contact_->solve(right);
      for (std::size_t r = 0; r < impulse.size(); ++r)
        out.push_back({element("impulse_dtheta", static_cast<int>(r), c), impulse[r]});
      const Row direct = factorisation_.solve(r1);
      const Row change = combined(impulse);
      for (int r = 0; r < equations_.tree().position_count(); ++r)
        out.push_back({element("velocity_after_dtheta", r, c), direct[at(r)] + change[at(r)]});
    }
  }

 private:
  static Matrix with_armature(const Equations& equations) {
    Matrix mass = equations.mass_matrix();
    for (int j = 0; j < equations.tree().joint_count(); ++j)
      mass[at(3 + j)][at(3 + j)] += equations.armature(j);
    return mass;
  }

  static Matrix rows_of(const Equations& equations, const std::vector<int>& feet) {
    Matrix rows;
    for (const int foot : feet) {
      for (const Row& row : equations.foot_jacobian(foot)) rows.push_back(row);
    }
    return rows;
  }

  static Row negated(Row row) {
    for (Expression& e : row) e = -e;
    return row;
  }

  /// J v.
  [[nodiscard]] Row products(const Row& v) const {
    Row result;
    for (const Row& row : jacobian_) result.push_back(inner(row, v));
    return result;
  }

  /// J X of the rows of X'.
  [[nodiscard]] Matrix products(const Matrix& response) const {
    Matrix result;
    for (const Row& row : jacobian_) {
      result.emplace_back();
      for (const Row& column : response) result.back().push_back(inner(row, column));
    }
    return result;
  }

  /// X impulse.
  [[nodiscard]] Row combined(const Row& impulse) const {
    Row result;
    for (std::size_t i = 0; i < response_[0].size(); ++i) {
      Expression sum = response_[0][i] * impulse[0];
      for (std::size_t k = 1; k < impulse.size(); ++k) sum += response_[k][i] * impulse[k];
      result.push_back(sum);
    }
    return result;
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
    for (std::size_t i = 0; i < feet_.size(); ++i)
      motion.force[at(feet_[i])] = {impulse_[2 * i], impulse_[2 * i + 1]};
    Row held = motion.acceleration;
    held.insert(held.end(), {jump_[0], jump_[1]});
    held.insert(held.end(), impulse_.begin(), impulse_.end());
    Differentiator differentiate(cuts(held));
    return equations_.jacobian(equations_.equations(motion).row, equations_.angles(), differentiate);
  }

  [[nodiscard]] Matrix contact_velocity_by_angles() const {
    Differentiator differentiate(cuts(after_));
    Matrix result;
    for (const Row& contact : jacobian_) {
      Row row;
      for (int c = 0; c < equations_.tree().link_count(); ++c) {
        Expression sum = equations_.graph().constant(0.0);
        for (int k = 0; k < equations_.tree().link_count(); ++k) {
          const Matrix second = equations_.jacobian({contact[at(2 + k)]}, equations_.angles(), differentiate);
          sum += second[0][at(c)] * after_[at(2 + k)];
        }
        row.push_back(sum);
      }
      result.push_back(row);
    }
    return result;
  }

  const Equations& equations_;
  std::vector<int> feet_;
  TreeFactorisation factorisation_;
  Matrix jacobian_;
  Matrix response_;  ///< X', two rows a foot
  std::optional<ContactInverse> contact_;
  Row impulse_;
  Row jump_;   ///< v+ - v-
  Row after_;  ///< v+
};

std::string side_name(const std::string& foot) {
  std::string side = foot.substr(std::string("foot_").size());
  if (side == "L") return "left";
  if (side == "R") return "right";
  return side;
}

}  // namespace

std::vector<FunctionSpec> impact_functions(const Equations& equations, const std::vector<int>& feet) {
  std::string names;
  for (const int foot : feet) names += (names.empty() ? "" : " and ") + equations.tree().feet[at(foot)].name;
  const std::string text =
      "Rigid impact without slip or rebound of " + names +
      ": x holds q and the velocities before,\nvelocity_after those after (SI), impulse "
      "[x, z] of each in Ns acts on the robot; M velocity_after - J' impulse = M v,\n"
      "J velocity_after = 0. joint_parameters: armature of each joint (kg m^2) enters M.";
  const ImpactModel model(equations, feet);
  const std::string side = feet.size() == 1 ? side_name(equations.tree().feet[at(feet[0])].name) : "both";
  FunctionSpec values{.name = "impact_" + side,
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
