#pragma once

#include <Eigen/Core>
#include <vector>

#include "host_tools/gait_synthesis/nonlinear_program/nonlinear_program.h"
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
class PlanningNlp final : public nonlinear_program::NonlinearProgram {
 public:
  explicit PlanningNlp(const Scene& scene);

  [[nodiscard]] int variable_count() const { return variables_; }
  [[nodiscard]] int constraint_count() const { return constraints_; }

  [[nodiscard]] Eigen::VectorXd pack(const ocp::Trajectory& iterate) const;
  void unpack(const Eigen::VectorXd& v, ocp::Trajectory& iterate) const;

  [[nodiscard]] Bounds variable_bounds() const override;
  [[nodiscard]] Bounds constraint_bounds() const override;
  [[nodiscard]] double objective(const Eigen::VectorXd& v) const override;
  [[nodiscard]] Eigen::VectorXd gradient(const Eigen::VectorXd& v) const override;
  [[nodiscard]] Eigen::VectorXd constraints(const Eigen::VectorXd& v) const override;
  [[nodiscard]] std::vector<Entry> jacobian(const Eigen::VectorXd& v) const override;
  [[nodiscard]] std::vector<Entry> hessian(const Eigen::VectorXd& v, double factor,
                                           const Eigen::VectorXd& multipliers) const override;

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

}  // namespace stilt::testing_support
