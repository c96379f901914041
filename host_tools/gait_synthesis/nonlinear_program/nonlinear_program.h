#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace stilt::nonlinear_program {

/// minimise f(v) subject to lower <= g(v) <= upper and variable bounds, with sparse first and second
/// derivatives. A matrix is a list of entries, always in the same order; duplicates are summed.
class NonlinearProgram {
 public:
  struct Entry {
    int row;
    int column;
    double value;
  };
  struct Bounds {
    Eigen::VectorXd lower, upper;
  };

  virtual ~NonlinearProgram() = default;
  [[nodiscard]] virtual Bounds variable_bounds() const = 0;
  [[nodiscard]] virtual Bounds constraint_bounds() const = 0;
  [[nodiscard]] virtual double objective(const Eigen::VectorXd& v) const = 0;
  [[nodiscard]] virtual Eigen::VectorXd gradient(const Eigen::VectorXd& v) const = 0;
  [[nodiscard]] virtual Eigen::VectorXd constraints(const Eigen::VectorXd& v) const = 0;
  [[nodiscard]] virtual std::vector<Entry> jacobian(const Eigen::VectorXd& v) const = 0;
  /// Lower triangle of the Hessian of factor * f + multipliers' g.
  [[nodiscard]] virtual std::vector<Entry> hessian(const Eigen::VectorXd& v, double factor,
                                                   const Eigen::VectorXd& multipliers) const = 0;
};

struct IpoptOptions {
  double tolerance = 1e-8;
  int iterations_max = 500;
  double time_max_s = 60.0;  ///< processor time, limits problems without solution
};

struct IpoptSolution {
  /// The constraints hold within the tolerance, and the optimality conditions too or at least to 1e-6. Along
  /// a direction in which the cost is nearly flat, rounding keeps Ipopt from more.
  bool solved = false;
  std::string status;  ///< in words
  double cost = 0.0;
  double constraint_violation = 0.0;  ///< of the last iterate, beyond the bounds that Ipopt works with
  int iterations = 0;
  Eigen::VectorXd v;
};

/// Solves from `start` by Ipopt. Not thread-safe: its linear solver has shared state.
[[nodiscard]] IpoptSolution solve(const NonlinearProgram& program, const Eigen::VectorXd& start,
                                  const IpoptOptions& options);

}  // namespace stilt::nonlinear_program
