#include "host_tools/benchmark/planner_kernels.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <memory>

#include "host_tools/benchmark/phase_speeds.h"
#include "tests/benchmarks/baseline_linearise.h"
#include "tests/benchmarks/baseline_sweep.h"
#include "tests/mpc_core/lq/dense_stage.h"
#include "tests/robots.h"

namespace stilt::benchmark {
namespace {

using gait::GaitKind;
using model::kStates;

/// What of a stage's model does not depend on the choice of its free directions.
struct EssentialModel {
  Eigen::MatrixXd dynamics;   ///< A - B R^-1 S
  Eigen::MatrixXd hessian;    ///< Q - S'R^-1 S
  Eigen::MatrixXd influence;  ///< B R^-1 B'

  EssentialModel(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Eigen::MatrixXd& Q,
                 const Eigen::MatrixXd& S, const Eigen::MatrixXd& R) {
    const Eigen::LDLT<Eigen::MatrixXd> factor(R);
    dynamics = A - B * factor.solve(S);
    hessian = Q - S.transpose() * factor.solve(S);
    influence = B * factor.solve(B.transpose());
  }
  explicit EssentialModel(const BaselineModel& m)
      : EssentialModel(m.A, m.B.leftCols(m.free), m.Q, m.S.topRows(m.free),
                       m.R.topLeftCorner(m.free, m.free)) {}
  explicit EssentialModel(const LqStage& stage)
      : EssentialModel(lq::testing::dense_dynamics(stage), columns(stage.B, stage.free_inputs),
                       lq::testing::dense_hessian(stage), columns(stage.S, stage.free_inputs).transpose(),
                       input_hessian(stage)) {}

 private:
  static Eigen::MatrixXd columns(const double (*from)[lq::kRows], int count) {
    using Padded = Eigen::Map<const Eigen::Matrix<double, lq::kRows, Eigen::Dynamic>>;
    return Padded(&from[0][0], lq::kRows, count).topRows(kStates);
  }
  static Eigen::MatrixXd input_hessian(const LqStage& stage) {
    Eigen::MatrixXd R(stage.free_inputs, stage.free_inputs);
    for (int i = 0; i < stage.free_inputs; ++i) {
      for (int j = i; j < stage.free_inputs; ++j) R(i, j) = R(j, i) = stage.R[i][j];
    }
    return R;
  }
};

double difference(const EssentialModel& a, const EssentialModel& b) {
  const auto relative = [](const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) {
    return (x - y).norm() / y.norm();
  };
  return std::max(
      {relative(a.dynamics, b.dynamics), relative(a.hessian, b.hessian), relative(a.influence, b.influence)});
}

control::ControllerParameters short_horizon() {
  control::ControllerParameters parameters;
  parameters.discretisation.horizon_s = 0.15;
  parameters.gait.double_support_s = 0.05;
  parameters.sqp.iterations = 3;
  parameters.sqp.early_stop = false;
  return parameters;
}

/// A planner that stood first and now plans the first step: both feet on the ground, then one, then the
/// other.
class Kernels : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(planner_->configure(testing_support::amber3m(), short_horizon()), control::ConfigureStatus::ok);
    planner_->reset(0.0);
    plan_at(0.0);
  }

  sqp::SolveReport plan_at(double time_s) {
    const control::PlannerInput input{
        time_s,
        gait::standing_state(testing_support::amber3m().constants, 0.8, 0.0, 0.15, true),
        {GaitKind::walk, 0.4}};
    return planner_->plan(input, *plan_);
  }

  /// The problem that the planner solved last, at its solution.
  [[nodiscard]] LinearisedProblem linearised() const {
    const auto models = std::make_unique<ocp::StageModels>();
    return {*models, planner_->problem_data(), planner_->problem(), planner_->solution()};
  }

  const std::unique_ptr<control::Planner> planner_ = std::make_unique<control::Planner>();
  const std::unique_ptr<control::Plan> plan_ = std::make_unique<control::Plan>();
};

TEST_F(Kernels, BothSweepsGiveTheSameGains) {
  plan_at(0.25);
  const LinearisedProblem problem = linearised();
  BaselineSweep baseline(problem.stages, problem.terminal);
  baseline.run();
  lq::RiccatiWorkspace workspace;
  lq::BackwardSweep sweep(problem.terminal, workspace);
  for (std::size_t k = problem.stages.size(); k-- > 0;) {
    const LqStage& stage = problem.stages[k];
    lq::LqGain gain;
    ASSERT_EQ(sweep.step(stage, stage, gain), lq::SweepOutcome::ok) << "stage " << k;
    const Eigen::MatrixXd expected = baseline.gain(static_cast<int>(k));
    ASSERT_EQ(expected.rows(), stage.free_inputs) << "stage " << k;
    if (expected.size() == 0) continue;
    const double largest = expected.cwiseAbs().maxCoeff();
    for (int i = 0; i < stage.free_inputs; ++i) {
      for (int c = 0; c < kStates; ++c) {
        EXPECT_NEAR(gain.K[i][c], expected(i, c), 1e-9 * largest) << "stage " << k;
      }
    }
  }
}

/// Both choose their free directions differently: compared is what does not depend on that choice.
TEST_F(Kernels, BothLinearisationsGiveTheSameModel) {
  plan_at(0.25);
  const LinearisedProblem problem = linearised();
  const ocp::Problem& batches = planner_->problem();
  const auto baseline = std::make_unique<BaselineModel>();
  for (int b = 0; b < batches.batches; ++b) {
    const ocp::StageBatch& batch = batches.batch[b];
    for (int lane = 0; lane < batch.lanes; ++lane) {
      baseline_linearise(planner_->problem_data(), batch, lane, planner_->solution(), *baseline);
      const LqStage& stage = problem.stages[static_cast<std::size_t>(batch.stage[lane])];
      EXPECT_LT(difference(EssentialModel(stage), EssentialModel(*baseline)), 1e-9)
          << "batch " << b << ", lane " << lane;
    }
  }
}

TEST_F(Kernels, WorkOfThePartsIsTheWorkOfTheWhole) {
  if (!can_count_work()) GTEST_SKIP() << "this processor or build cannot be stepped through";
  plan_at(0.25);
  const auto table = std::make_unique<WorkTable>();
  (void)table->work_of(*planner_);
  plan_at(0.26);  // other numbers, which must not change the work
  const IterationWork work = table->work_of(*planner_);

  PlannerKernels kernels(*planner_);
  const auto expect_same = [](const ExecutedWork& sum, const ExecutedWork& whole, const char* phase) {
    const auto near = [&](long long a, long long b, double share) {
      EXPECT_GT(b, 0) << phase;
      EXPECT_NEAR(static_cast<double>(a), static_cast<double>(b), share * static_cast<double>(b)) << phase;
    };
    near(sum.flops, whole.flops, 0.005);
    near(sum.instructions, whole.instructions,
         0.01);  // with AVX-512 there are half as many, for the same loops
  };
  expect_same(work.linearise, count_work([&] { kernels.linearise(); }), "linearise");
  expect_same(work.evaluate, count_work([&] { kernels.evaluate(); }), "evaluate");
  expect_same(work.sweep, count_work([&] { kernels.sweep(); }), "sweep");
}

TEST_F(Kernels, EveryIterationTriesAtLeastOneStep) {
  const sqp::SolveReport report = plan_at(0.25);
  EXPECT_EQ(report.iterations, 3);
  EXPECT_GE(report.trial_steps, report.iterations);
}

TEST_F(Kernels, TheTextbookSweepNeedsMoreOperationsWithMoreInputs) {
  EXPECT_EQ(textbook_sweep_flops(0), 2 * 14 * 14 * 14 + 14 * 15 * 14 + 6 * 14 * 14);
  for (int inputs = 1; inputs <= 4; ++inputs) {
    EXPECT_GT(textbook_sweep_flops(inputs), textbook_sweep_flops(inputs - 1));
  }
}

TEST_F(Kernels, SpeedsFollowFromTimeAndWork) {
  plan_at(0.25);
  PlannerKernels kernels(*planner_);
  const IterationWork work{{10, 1000000}, {10, 2000000}, {10, 3000000}};
  const PhaseSpeeds speeds = measure_phases(kernels, work, 3);
  for (const PhaseSpeed& phase : {speeds.linearise, speeds.sweep, speeds.evaluate}) {
    EXPECT_NEAR(phase.rate_gflop_s * phase.time_us, 1e-3 * static_cast<double>(phase.work.flops), 1e-6);
    EXPECT_NEAR(phase.peak_share * speeds.peak_gflop_s, phase.rate_gflop_s,
                1e-9 * std::abs(phase.rate_gflop_s));
  }
  // Time of the sweep is a difference of two measured ones, so its sign is left to the clock.
  EXPECT_GT(speeds.linearise.time_us, 0.0);
  EXPECT_GT(speeds.evaluate.time_us, 0.0);
}

}  // namespace
}  // namespace stilt::benchmark
