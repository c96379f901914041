#pragma once

#include <Eigen/Core>

#include "mpc_core/ocp/problem.h"

/// The linearisation of a stage as one writes it with fixed-size Eigen, node by node. The project's batched
/// linearisation is timed against it, on the same data. The scalar generated function gives derivatives by
/// state and input. The equality constraints are eliminated by a Householder QR decomposition. Cost rows make
/// a Gauss-Newton Hessian J'WJ, projected with the basis of the null space. Heun's method.
namespace stilt::benchmark {

/// Largest number of free inputs: 8 less the constraints of double support.
inline constexpr int kBaselineFree = 4;

/// The quadratic model of one stage over (dx, w); of w the first `free` entries count.
struct BaselineModel {
  Eigen::Matrix<double, model::kStates, model::kStates> A, Q;
  Eigen::Matrix<double, model::kStates, kBaselineFree> B;
  Eigen::Matrix<double, kBaselineFree, model::kStates> S;
  Eigen::Matrix<double, kBaselineFree, kBaselineFree> R;
  model::StateVector b, q;
  Eigen::Matrix<double, kBaselineFree, 1> r;
  int free = 0;
};

/// Linearises flow stage k. `batch` and `lane` are where its references are stored.
void baseline_linearise(const ocp::ProblemData& data, const ocp::StageBatch& batch, int lane,
                        const ocp::Trajectory& iterate, BaselineModel& out);

}  // namespace stilt::benchmark
