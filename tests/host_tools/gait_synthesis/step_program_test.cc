#include "host_tools/gait_synthesis/step_program.h"

#include <gtest/gtest.h>

#include <random>

#include "host_tools/gait_synthesis/initial_guess.h"
#include "tests/robots.h"

namespace stilt::gait_synthesis {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Case {
  double speed_m_s;
  gait::PhaseKind phase;
  CostKind cost;
};

StepTask small_task(const Case& c) {
  StepTask task;
  task.speed_m_s = c.speed_m_s;
  task.phase = c.phase;
  task.cost = c.cost;
  task.elements = 2;
  task.element_degree = 3;
  return task;
}

MatrixXd dense(const std::vector<StepProgram::Entry>& entries, Eigen::Index rows, Eigen::Index columns) {
  MatrixXd matrix = MatrixXd::Zero(rows, columns);
  for (const auto& entry : entries) matrix(entry.row, entry.column) += entry.value;
  return matrix;
}

class StepProgramTest : public testing::TestWithParam<Case> {
 protected:
  /// A step off its initial guess, so that nothing vanishes by symmetry.
  void SetUp() override {
    start_ = initial_guess(testing_support::amber3m().constants, task_, program_);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> move(-0.02, 0.02);
    for (double& value : start_) value += move(random);
  }
  static constexpr std::uint32_t kSeed = 7;
  const testing::ScopedTrace trace_{__FILE__, __LINE__, kSeed};
  const StepTask task_ = small_task(GetParam());
  const StepProgram program_{testing_support::amber3m(), task_};
  VectorXd start_;
};

TEST_P(StepProgramTest, JacobianIsTheSlopeOfTheConstraints) {
  constexpr double kMove = 1e-6;
  const VectorXd g = program_.constraints(start_);
  const MatrixXd jacobian = dense(program_.jacobian(start_), g.size(), start_.size());
  for (Eigen::Index c = 0; c < start_.size(); ++c) {
    VectorXd ahead = start_;
    VectorXd behind = start_;
    ahead[c] += kMove;
    behind[c] -= kMove;
    const VectorXd slope = (program_.constraints(ahead) - program_.constraints(behind)) / (2.0 * kMove);
    const double size = 1.0 + slope.cwiseAbs().maxCoeff();
    EXPECT_LT((jacobian.col(c) - slope).cwiseAbs().maxCoeff(), 2e-6 * size) << "variable " << c;
  }
}

TEST_P(StepProgramTest, GradientIsTheSlopeOfTheObjective) {
  constexpr double kMove = 1e-5;
  const VectorXd gradient = program_.gradient(start_);
  const double size = 1.0 + gradient.cwiseAbs().maxCoeff();
  for (Eigen::Index c = 0; c < start_.size(); ++c) {
    VectorXd ahead = start_;
    VectorXd behind = start_;
    ahead[c] += kMove;
    behind[c] -= kMove;
    const double slope = (program_.objective(ahead) - program_.objective(behind)) / (2.0 * kMove);
    EXPECT_NEAR(gradient[c], slope, 1e-6 * size) << "variable " << c;
  }
}

TEST_P(StepProgramTest, HessianIsTheSlopeOfTheLagrangiansGradient) {
  constexpr double kMove = 1e-5;
  const Eigen::Index rows = program_.constraints(start_).size();
  constexpr std::uint32_t kWeightSeed = 11;
  SCOPED_TRACE(kWeightSeed);
  std::mt19937 random(kWeightSeed);
  std::uniform_real_distribution<double> weight(-1.0, 1.0);
  VectorXd multipliers(rows);
  for (double& value : multipliers) value = weight(random);
  constexpr double kFactor = 0.7;
  const auto gradient = [&](const VectorXd& v) -> VectorXd {
    return kFactor * program_.gradient(v) +
           dense(program_.jacobian(v), rows, v.size()).transpose() * multipliers;
  };
  const MatrixXd lower = dense(program_.hessian(start_, kFactor, multipliers), start_.size(), start_.size());
  ASSERT_EQ(MatrixXd(lower.triangularView<Eigen::StrictlyUpper>()).cwiseAbs().maxCoeff(), 0.0);
  const MatrixXd hessian = lower.selfadjointView<Eigen::Lower>();
  const double size = 1.0 + hessian.cwiseAbs().maxCoeff();
  for (Eigen::Index c = 0; c < start_.size(); ++c) {
    VectorXd ahead = start_;
    VectorXd behind = start_;
    ahead[c] += kMove;
    behind[c] -= kMove;
    const VectorXd slope = (gradient(ahead) - gradient(behind)) / (2.0 * kMove);
    EXPECT_LT((hessian.col(c) - slope).cwiseAbs().maxCoeff(), 1e-5 * size) << "variable " << c;
  }
}

INSTANTIATE_TEST_SUITE_P(Phases, StepProgramTest,
                         testing::Values(Case{0.5, gait::PhaseKind::hip_position, CostKind::torque_squared},
                                         Case{-0.3, gait::PhaseKind::hip_position,
                                              CostKind::mechanical_power},
                                         Case{0.0, gait::PhaseKind::time, CostKind::acceleration_squared}));

}  // namespace
}  // namespace stilt::gait_synthesis
