#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "mpc_core/ocp/problem.h"

/// The planning problem once more, one stage and one number at a time: what the batched code is compared
/// with. Shares with it the generated dynamics (tested against MuJoCo) and the parameter structs, nothing
/// else. The integrator is the textbook Runge-Kutta method on all 14 states, logarithms are the standard
/// library's.
///
/// Everything is a template over T = double or Complex; an imaginary step gives derivatives exact to
/// rounding.
namespace stilt::testing_support {

using Complex = std::complex<double>;
inline constexpr double kComplexStep = 1e-30;

/// Both x and u of a stage.
inline constexpr int kStageVariables = model::kStates + model::kInputs;
template <class T>
using StageVector = Eigen::Matrix<T, kStageVariables, 1>;
template <class T>
using StateOf = Eigen::Matrix<T, model::kStates, 1>;

/// One term phi(y) of the running cost: 1/2 weight (y - reference)^2, or the relaxed barrier of y >= 0.
template <class T>
struct CostTerm {
  T y;
  double weight = 0.0;
  double reference = 0.0;
  const ocp::BarrierParameters* barrier = nullptr;  ///< a barrier when set

  [[nodiscard]] T value() const;
  [[nodiscard]] double first() const;   ///< phi'
  [[nodiscard]] double second() const;  ///< phi''
};

class ScalarOcp {
 public:
  explicit ScalarOcp(const ocp::ProblemData& data) : data_(data) {}

  /// x' = [v; base acceleration; joint accelerations].
  template <class T>
  [[nodiscard]] StateOf<T> flow(const StateOf<T>& x, const T* u) const;

  /// One Runge-Kutta step of a stage's variables z = [x; u].
  template <class T>
  [[nodiscard]] StateOf<T> step(const StageVector<T>& z, double duration_s) const;

  /// All terms of the running cost at one node; the cost of a stage is its duration times their sum.
  template <class T>
  [[nodiscard]] std::vector<CostTerm<T>> cost_terms(model::ContactMode mode,
                                                    const gait::ReferencePoint& reference,
                                                    const StageVector<T>& z) const;
  template <class T>
  [[nodiscard]] T running_cost(model::ContactMode mode, const gait::ReferencePoint& reference,
                               const StageVector<T>& z) const;

  /// Equality residuals: 2 a stance foot, 3 a swing foot.
  template <class T>
  [[nodiscard]] std::vector<T> equalities(model::ContactMode mode, const gait::ReferencePoint& reference,
                                          const StageVector<T>& z) const;

  /// State after a touch-down, the terms of its cost, and their sum.
  template <class T>
  [[nodiscard]] StateOf<T> transition(const ocp::Stage& stage, const StateOf<T>& x) const;
  template <class T>
  [[nodiscard]] std::vector<CostTerm<T>> touchdown_terms(const ocp::Stage& stage, const StateOf<T>& x) const;
  template <class T>
  [[nodiscard]] T touchdown_cost(const ocp::Stage& stage, const StateOf<T>& x) const;

  [[nodiscard]] double terminal_cost(const ocp::Problem& problem, const double* x) const;

  /// Merit of a whole iterate; `points` holds the reference of every stage.
  [[nodiscard]] ocp::Merit evaluate(const ocp::Problem& problem,
                                    const std::vector<gait::ReferencePoint>& points,
                                    const ocp::Trajectory& iterate) const;

 private:
  const ocp::ProblemData& data_;
};

/// Variables of stage k.
[[nodiscard]] StageVector<double> stage_variables(const ocp::Trajectory& iterate, int k);

/// Derivative of a vector function of z along `direction`, by complex step.
template <class Function>
[[nodiscard]] Eigen::VectorXd directional(const Function& function, const StageVector<double>& z,
                                          const StageVector<double>& direction) {
  StageVector<Complex> stepped = z.cast<Complex>();
  stepped.imag() = kComplexStep * direction;
  const auto values = function(stepped);
  Eigen::VectorXd result(static_cast<Eigen::Index>(values.size()));
  for (Eigen::Index i = 0; i < result.size(); ++i) result[i] = values.data()[i].imag() / kComplexStep;
  return result;
}

/// Derivative of a vector function by all of z: one row a component.
template <class Function>
[[nodiscard]] Eigen::MatrixXd jacobian(const Function& function, const StageVector<double>& z) {
  Eigen::MatrixXd result;
  for (int c = 0; c < kStageVariables; ++c) {
    const Eigen::VectorXd column = directional(function, z, StageVector<double>::Unit(c));
    if (c == 0) result.resize(column.size(), kStageVariables);
    result.col(c) = column;
  }
  return result;
}

}  // namespace stilt::testing_support
