#pragma once

#include <Eigen/Core>

#include "mpc_core/lq/lq_problem.h"

/// The factored matrices of a stage written out.
namespace stilt::lq::testing {

/// A of x_{k+1} = A x + B w + b.
[[nodiscard]] inline Eigen::Matrix<double, kStates, kStates> dense_dynamics(const LqFirstOrder& stage) {
  using Row = Eigen::Map<const Eigen::Matrix<double, 1, kStates>>;
  Eigen::Matrix<double, kStates, kStates> A;
  A.setIdentity();
  if (stage.form == StageForm::transition) {
    for (int i = 0; i < model::kPositions; ++i) A.row(model::kPositions + i) += Row(stage.G[i]);
    return A;
  }
  for (int i = 0; i < model::kPositions; ++i) A(i, model::kPositions + i) = stage.h;
  for (int i = 0; i < kBaseRows; ++i) A.row(kBaseRow[i]) += Row(stage.G[i]);
  for (int r = 0; r < stage.constraints; ++r) {
    A += Row(stage.L[r]).transpose() * Row(stage.G[kBaseRows + r]);
  }
  return A;
}

/// Q, both halves.
[[nodiscard]] inline Eigen::Matrix<double, kStates, kStates> dense_hessian(const LqSecondOrder& stage) {
  Eigen::Matrix<double, kStates, kStates> Q;
  for (int c = 0; c < kStates; ++c) {
    for (int r = c; r < kStates; ++r) Q(r, c) = Q(c, r) = stage.Q[c][r];
  }
  return Q;
}

}  // namespace stilt::lq::testing
