#pragma once

#include "firmware/configuration/gaits/gait_limits.h"
#include "host_tools/gait_synthesis/joint_bounds.h"
#include "host_tools/gait_synthesis/lobatto.h"
#include "host_tools/gait_synthesis/nonlinear_program/nonlinear_program.h"
#include "host_tools/gait_synthesis/step_node.h"
#include "mpc_core/gait/hzd_gait.h"

namespace stilt::gait_synthesis {

/// The step to find.
struct StepTask {
  double speed_m_s = 0.5;
  double step_time_s = 0.3;
  gait::PhaseKind phase = gait::PhaseKind::hip_position;
  int output_degree = 6;
  int elements = 8;        ///< equal parts of the step, at first
  int element_degree = 4;  ///< of the polynomials within one element; the order of accuracy is twice that
  CostKind cost = CostKind::torque_squared;
  gait_files::GaitLimits limits;

  [[nodiscard]] double step_length_m() const { return speed_m_s * step_time_s; }
};

// clang-format off
/// One periodic step on the left foot as a nonlinear program, by direct collocation (Lobatto IIIA, of which
/// Hermite-Simpson is the case of degree 2):
///
///   variables    at every node q, v, dv/dt and the force on the stance foot; Bezier coefficients of the
///                outputs
///   constraints  integrals: q and v are the integrals of v and dv/dt over each element;
///                nodes: the base rows of the dynamics hold, the stance foot does not accelerate, every joint
///                accelerates as its Bezier polynomial of the phase does;
///                first node: stance foot and outputs also hold in position and velocity;
///                period: the posture after the exchange of the legs and the rates after the impact map equal
///                those at the start, so that the outputs are hybrid invariant; the base has moved
///                one step length;
///                limits: those of GaitLimits, torques and joint speeds also those of the robot.
// clang-format on
class StepProgram final : public nonlinear_program::NonlinearProgram {
 public:
  StepProgram(const model::RobotModel& robot, const StepTask& task);

  [[nodiscard]] Bounds variable_bounds() const override;
  [[nodiscard]] Bounds constraint_bounds() const override;
  [[nodiscard]] double objective(const Eigen::VectorXd& v) const override;
  [[nodiscard]] Eigen::VectorXd gradient(const Eigen::VectorXd& v) const override;
  [[nodiscard]] Eigen::VectorXd constraints(const Eigen::VectorXd& v) const override;
  [[nodiscard]] std::vector<Entry> jacobian(const Eigen::VectorXd& v) const override;
  [[nodiscard]] std::vector<Entry> hessian(const Eigen::VectorXd& v, double factor,
                                           const Eigen::VectorXd& multipliers) const override;

  /// Times of the nodes / step time, from 0 to 1.
  [[nodiscard]] const Eigen::VectorXd& node_times() const { return time_; }

  /// Variables of a motion given at the nodes: q, v, dv/dt [7, nodes] each. Fits the outputs.
  [[nodiscard]] Eigen::VectorXd pack(const Eigen::MatrixXd& q, const Eigen::MatrixXd& v,
                                     const Eigen::MatrixXd& a) const;
  /// The outputs of a solution, and its state just after touch-down.
  [[nodiscard]] gait::GaitOutputs outputs(const Eigen::VectorXd& v) const;
  [[nodiscard]] model::StateVector start_state(const Eigen::VectorXd& v) const {
    return v.head<model::kStates>();
  }

 private:
  // Indices of variables and rows.
  [[nodiscard]] int node_at(int node) const { return node * kNodeVariables; }
  [[nodiscard]] int coefficient_at(int joint, int i) const {
    return nodes_ * kNodeVariables + joint * (task_.output_degree + 1) + i;
  }
  [[nodiscard]] int variables() const { return coefficient_at(model::kJoints, 0); }
  [[nodiscard]] int node_rows_at(int node) const { return node * kNodeRows; }
  [[nodiscard]] int integral_row(int node) const {  // for all nodes but the first
    return nodes_ * kNodeRows + (node - 1) * model::kStates;
  }
  [[nodiscard]] int output_row(int node) const { return integral_row(nodes_) + node * model::kJoints; }
  [[nodiscard]] int first_output_row() const { return output_row(nodes_); }
  [[nodiscard]] int period_row() const { return first_output_row() + 2 * model::kJoints; }
  [[nodiscard]] int impact_row() const { return period_row() + model::kPositions; }
  [[nodiscard]] int rows() const { return impact_row() + kImpactRows; }

  [[nodiscard]] NodeVector node(const Eigen::VectorXd& v, int k) const {
    return v.segment<kNodeVariables>(node_at(k));
  }
  [[nodiscard]] ImpactVector last_state(const Eigen::VectorXd& v) const {
    return v.segment<kImpactVariables>(node_at(nodes_ - 1));
  }
  [[nodiscard]] Eigen::VectorXd coefficients(const Eigen::VectorXd& v, int joint) const {
    return v.segment(coefficient_at(joint, 0), task_.output_degree + 1);
  }

  /// Phase s of a node with its first and second derivative by time.
  struct Phase {
    double s, rate, acceleration;
  };
  [[nodiscard]] Phase phase(const Eigen::VectorXd& v, int node) const;

  void bound_node(int node, Bounds& bounds) const;
  void integrals(const Eigen::VectorXd& v, Eigen::VectorXd& g) const;
  void output_rows(const Eigen::VectorXd& v, Eigen::VectorXd& g) const;
  void period_rows(const Eigen::VectorXd& v, Eigen::VectorXd& g) const;
  void add_integrals(std::vector<Entry>& entries) const;
  void add_outputs(const Eigen::VectorXd& v, int node, std::vector<Entry>& entries) const;
  void add_first_outputs(const Eigen::VectorXd& v, std::vector<Entry>& entries) const;
  void add_period(const Eigen::VectorXd& v, std::vector<Entry>& entries) const;
  void add_output_hessian(const Eigen::VectorXd& v, int node, const Eigen::VectorXd& multipliers,
                          std::vector<Entry>& entries) const;
  void add_first_output_hessian(const Eigen::VectorXd& multipliers, std::vector<Entry>& entries) const;

  StepTask task_;
  model::RobotConstants constants_;
  JointBounds joint_bounds_;
  LobattoBasis basis_;  ///< of one element
  StepNode node_;
  StepImpact impact_;
  int nodes_;
  double element_s_;
  bool by_hip_;
  Eigen::VectorXd time_;    ///< of the nodes / step time
  Eigen::VectorXd weight_;  ///< quadrature of the cost over [0, 1]
};

}  // namespace stilt::gait_synthesis
