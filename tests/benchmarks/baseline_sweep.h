#pragma once

#include <Eigen/Core>
#include <span>
#include <variant>
#include <vector>

#include "host_tools/benchmark/lq_stage.h"

/// The Riccati recursion of riccati.h as one writes it with fixed-size Eigen: what the project's sweep is
/// timed against, on the same data.
namespace stilt::benchmark {

/// One stage with `kInputs` free inputs, in Eigen's own layout.
template <int kInputs>
struct BaselineStage {
  Eigen::Matrix<double, lq::kStates, lq::kStates> A, Q;
  Eigen::Matrix<double, lq::kStates, kInputs> B;
  Eigen::Matrix<double, kInputs, lq::kStates> S, K;
  Eigen::Matrix<double, kInputs, kInputs> R;
  Eigen::Matrix<double, lq::kStates, 1> b, q;
  Eigen::Matrix<double, kInputs, 1> r, k;
};

class BaselineSweep {
 public:
  /// Copies the problem. Throws std::invalid_argument for a stage with 1 or more than 4 free inputs.
  BaselineSweep(std::span<const LqStage> stages, const lq::LqTerminal& terminal);

  /// The backward sweep; gains stay in the stages.
  void run();

  /// Feedback of stage k, inputs x states; empty where there are no free inputs.
  [[nodiscard]] Eigen::MatrixXd gain(int stage) const;

 private:
  struct Transition {  ///< no inputs
    Eigen::Matrix<double, lq::kStates, lq::kStates> A, Q;
    Eigen::Matrix<double, lq::kStates, 1> b, q;
  };
  using Stage = std::variant<Transition, BaselineStage<2>, BaselineStage<3>, BaselineStage<4>>;

  void step(Transition& stage);
  template <int kInputs>
  void step(BaselineStage<kInputs>& stage);

  std::vector<Stage> stages_;
  Eigen::Matrix<double, lq::kStates, lq::kStates> terminal_, P_, PA_;
  Eigen::Matrix<double, lq::kStates, 1> terminal_gradient_, p_, pb_;
};

}  // namespace stilt::benchmark
