#pragma once

#include <Eigen/Core>
#include <vector>

#include "tests/mpc_core/ocp/planning_scene.h"
#include "tests/mpc_core/ocp/scalar_ocp.h"

namespace stilt::testing_support {

/// A planning problem as one large nonlinear program over all states and inputs,
///
///   minimise f(v)  subject to  c(v) = 0:  initial state, dynamics of every stage, equalities of every flow
///   stage,
///
/// evaluated by ScalarOcp, with exact first derivatives by complex step and second derivatives of the
/// Lagrangian by differences of them. Scale: about 800 variables for 0.5 s.
class PlanningNlp {
 public:
  explicit PlanningNlp(const Scene& scene);

  [[nodiscard]] int variables() const { return variables_; }
  [[nodiscard]] int constraints() const { return constraints_; }

  [[nodiscard]] Eigen::VectorXd pack(const ocp::Trajectory& iterate) const;
  void unpack(const Eigen::VectorXd& v, ocp::Trajectory& iterate) const;

  [[nodiscard]] double objective(const Eigen::VectorXd& v) const;
  [[nodiscard]] Eigen::VectorXd gradient(const Eigen::VectorXd& v) const;
  [[nodiscard]] Eigen::VectorXd residuals(const Eigen::VectorXd& v) const;

  struct Entry {
    int row;
    int column;
    double value;
  };
  /// Entries always come in the same order.
  [[nodiscard]] std::vector<Entry> jacobian(const Eigen::VectorXd& v) const;
  /// Lower triangle of the Hessian of factor * f + multipliers' c, duplicates to be summed.
  [[nodiscard]] std::vector<Entry> hessian(const Eigen::VectorXd& v, double factor,
                                           const Eigen::VectorXd& multipliers) const;

 private:
  /// Where a stage's variables and constraints stand.
  struct Block {
    int first_variable;
    int variables;  ///< 22 of a flow, 14 of a transition
    int next_state;
    int first_row;
    int rows;
  };
  [[nodiscard]] StageVector<double> local_variables(const Eigen::VectorXd& v, const Block& block) const;
  /// Cost of stage k, then its constraints without the term of the next state.
  template <class T>
  [[nodiscard]] std::vector<T> local(int k, const StageVector<T>& z) const;

  const Scene& scene_;
  ScalarOcp scalar_;
  std::vector<Block> blocks_;
  int last_state_ = 0;
  int variables_ = 0;
  int constraints_ = 0;
};

/// What Ipopt found.
struct IpoptResult {
  bool solved = false;
  double cost = 0.0;
  int iterations = 0;
  Eigen::VectorXd v;
};
[[nodiscard]] IpoptResult solve_with_ipopt(const PlanningNlp& nlp, const Eigen::VectorXd& start);

}  // namespace stilt::testing_support
