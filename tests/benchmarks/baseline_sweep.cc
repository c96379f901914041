#include "tests/benchmarks/baseline_sweep.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "tests/mpc_core/lq/dense_stage.h"

namespace stilt::benchmark {
namespace {

using lq::kRows;
using model::kStates;

template <class Vector>
void copy_vector(const double* from, Vector& to) {
  for (Eigen::Index i = 0; i < to.size(); ++i) to[i] = from[i];
}

/// Columns padded to kRows; the lower half alone counts in a symmetric matrix.
template <class Matrix>
void copy_columns(const double (*from)[kRows], Matrix& to) {
  for (Eigen::Index c = 0; c < to.cols(); ++c) {
    for (Eigen::Index r = 0; r < to.rows(); ++r) to(r, c) = from[c][r];
  }
}

template <class Matrix>
void copy_symmetric(const double (*from)[kRows], Matrix& to) {
  for (int c = 0; c < kStates; ++c) {
    for (int r = 0; r < kStates; ++r) to(r, c) = from[std::min(r, c)][std::max(r, c)];
  }
}

template <class Stage>
void copy_state_part(const LqStage& from, Stage& to) {
  to.A = lq::testing::dense_dynamics(from);
  to.Q = lq::testing::dense_hessian(from);
  copy_vector(from.b, to.b);
  copy_vector(from.q, to.q);
}

template <int kInputs>
BaselineStage<kInputs> baseline_stage(const LqStage& from) {
  BaselineStage<kInputs> to;
  copy_state_part(from, to);
  copy_columns(from.B, to.B);
  for (int i = 0; i < kInputs; ++i) {
    for (int c = 0; c < kStates; ++c) to.S(i, c) = from.S[i][c];
    for (int j = 0; j < kInputs; ++j) to.R(i, j) = from.R[std::min(i, j)][std::max(i, j)];
    to.r[i] = from.r[i];
  }
  return to;
}

}  // namespace

BaselineSweep::BaselineSweep(std::span<const LqStage> stages, const lq::LqTerminal& terminal) {
  for (const LqStage& stage : stages) {
    switch (stage.free_inputs) {
      case 0: {
        Transition to;
        copy_state_part(stage, to);
        stages_.emplace_back(to);
        break;
      }
      case 2:
        stages_.emplace_back(baseline_stage<2>(stage));
        break;
      case 3:
        stages_.emplace_back(baseline_stage<3>(stage));
        break;
      case 4:
        stages_.emplace_back(baseline_stage<4>(stage));
        break;
      default:
        throw std::invalid_argument("BaselineSweep: a stage has " + std::to_string(stage.free_inputs) +
                                    " free inputs; 0, 2, 3 or 4 are known");
    }
  }
  copy_symmetric(terminal.Q, terminal_);
  copy_vector(terminal.q, terminal_gradient_);
}

void BaselineSweep::step(Transition& s) {
  PA_.noalias() = P_ * s.A;
  pb_ = p_;
  pb_.noalias() += P_ * s.b;
  P_ = s.Q;
  P_.noalias() += s.A.transpose() * PA_;
  P_ = (0.5 * (P_ + P_.transpose())).eval();
  p_ = s.q;
  p_.noalias() += s.A.transpose() * pb_;
}

template <int kInputs>
void BaselineSweep::step(BaselineStage<kInputs>& s) {
  PA_.noalias() = P_ * s.A;
  pb_ = p_;
  pb_.noalias() += P_ * s.b;
  const Eigen::Matrix<double, kStates, kInputs> PB = P_ * s.B;
  Eigen::Matrix<double, kInputs, kInputs> H = s.R;
  H.noalias() += s.B.transpose() * PB;
  Eigen::Matrix<double, kInputs, kStates> G = s.S;
  G.noalias() += s.B.transpose() * PA_;
  Eigen::Matrix<double, kInputs, 1> h = s.r;
  h.noalias() += s.B.transpose() * pb_;
  const Eigen::LLT<Eigen::Matrix<double, kInputs, kInputs>> cholesky(H);
  s.K = -cholesky.solve(G);
  s.k = -cholesky.solve(h);
  P_ = s.Q;
  P_.noalias() += s.A.transpose() * PA_;
  P_.noalias() += G.transpose() * s.K;
  P_ = (0.5 * (P_ + P_.transpose())).eval();
  p_ = s.q;
  p_.noalias() += s.A.transpose() * pb_;
  p_.noalias() += G.transpose() * s.k;
}

void BaselineSweep::run() {
  P_ = terminal_;
  p_ = terminal_gradient_;
  for (auto stage = stages_.rbegin(); stage != stages_.rend(); ++stage) {
    std::visit([this](auto& s) { step(s); }, *stage);
  }
}

Eigen::MatrixXd BaselineSweep::gain(int stage) const {
  return std::visit(
      [](const auto& s) -> Eigen::MatrixXd {
        if constexpr (std::is_same_v<std::decay_t<decltype(s)>, Transition>) {
          return Eigen::MatrixXd(0, kStates);
        } else {
          return s.K;
        }
      },
      stages_[static_cast<std::size_t>(stage)]);
}

}  // namespace stilt::benchmark
