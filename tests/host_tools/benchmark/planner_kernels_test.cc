#include "host_tools/benchmark/planner_kernels.h"

#include <gtest/gtest.h>

#include <memory>

#include "host_tools/benchmark/phase_speeds.h"
#include "tests/robots.h"

namespace stilt::benchmark {
namespace {

using gait::GaitKind;

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

  const std::unique_ptr<control::Planner> planner_ = std::make_unique<control::Planner>();
  const std::unique_ptr<control::Plan> plan_ = std::make_unique<control::Plan>();
};

TEST_F(Kernels, BothSweepsGiveTheSameGains) {
  plan_at(0.25);
  PlannerKernels kernels(*planner_);
  kernels.sweep();
  kernels.plain_sweep();
  EXPECT_LT(kernels.sweep_difference(), 1e-9);
}

TEST_F(Kernels, BothLinearisationsGiveTheSameModel) {
  plan_at(0.25);
  PlannerKernels kernels(*planner_);
  EXPECT_LT(kernels.linearisation_difference(), 1e-9);
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
    const auto near = [&](long long a, long long b) {
      EXPECT_GT(b, 0) << phase;
      EXPECT_NEAR(static_cast<double>(a), static_cast<double>(b), 0.005 * static_cast<double>(b)) << phase;
    };
    near(sum.flops, whole.flops);
    near(sum.instructions, whole.instructions);
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
    EXPECT_GT(phase.time_us, 0.0);
    EXPECT_NEAR(phase.rate_gflop_s * phase.time_us, 1e-3 * static_cast<double>(phase.work.flops), 1e-6);
    EXPECT_NEAR(phase.peak_share * speeds.peak_gflop_s, phase.rate_gflop_s, 1e-9 * phase.rate_gflop_s);
  }
}

}  // namespace
}  // namespace stilt::benchmark
