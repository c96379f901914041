#include <gtest/gtest.h>

#include <cmath>

#include "host_tools/gait_synthesis/nonlinear_program/nonlinear_program.h"

namespace stilt::nonlinear_program {
namespace {

using Eigen::VectorXd;

/// min (x - 1)^2 subject to x + y = 3, whose gradient and constraint have errors of constant size: Ipopt gets
/// no nearer to their zeros than that.
class Rounded final : public NonlinearProgram {
 public:
  Rounded(double gradient_error, double constraint_error)
      : gradient_error_(gradient_error), constraint_error_(constraint_error) {}

  [[nodiscard]] Bounds variable_bounds() const override {
    return {VectorXd::Constant(2, -10.0), VectorXd::Constant(2, 10.0)};
  }
  [[nodiscard]] Bounds constraint_bounds() const override { return {VectorXd::Zero(1), VectorXd::Zero(1)}; }
  [[nodiscard]] double objective(const VectorXd& v) const override { return (v[0] - 1.0) * (v[0] - 1.0); }
  [[nodiscard]] VectorXd gradient(const VectorXd& v) const override {
    VectorXd g = VectorXd::Zero(2);
    g[0] = 2.0 * (v[0] - 1.0) + std::copysign(gradient_error_, v[0] - 1.0);
    return g;
  }
  [[nodiscard]] VectorXd constraints(const VectorXd& v) const override {
    const double residual = v[0] + v[1] - 3.0;
    return VectorXd::Constant(1, residual + std::copysign(constraint_error_, residual));
  }
  [[nodiscard]] std::vector<Entry> jacobian(const VectorXd&) const override {
    return {{0, 0, 1.0}, {0, 1, 1.0}};
  }
  [[nodiscard]] std::vector<Entry> hessian(const VectorXd&, double factor, const VectorXd&) const override {
    return {{0, 0, 2.0 * factor}};
  }

 private:
  double gradient_error_, constraint_error_;
};

TEST(IpoptSolve, AnExactProgramIsSolved) {
  const IpoptSolution solution = solve(Rounded(0.0, 0.0), VectorXd::Zero(2), {});
  ASSERT_TRUE(solution.solved) << solution.status;
  EXPECT_NEAR(solution.v[0], 1.0, 1e-8);
  EXPECT_NEAR(solution.v[1], 2.0, 1e-8);
}

TEST(IpoptSolve, SolvedWhenTheConstraintsHoldAndOnlyTheOptimumIsRough) {
  const IpoptSolution solution = solve(Rounded(1e-7, 0.0), VectorXd::Zero(2), {});
  EXPECT_TRUE(solution.solved) << solution.status;
  EXPECT_NEAR(solution.v[0], 1.0, 1e-6);
}

TEST(IpoptSolve, NotSolvedWhenTheConstraintsHoldRoughlyOnly) {
  const IpoptSolution solution = solve(Rounded(0.0, 1e-7), VectorXd::Zero(2), {});
  EXPECT_FALSE(solution.solved) << solution.status;
}

}  // namespace
}  // namespace stilt::nonlinear_program
